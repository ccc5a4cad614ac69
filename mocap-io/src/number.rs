//! Numbers in text, read exactly as `str::parse::<f64>` reads them, and the room for them.
//!
//! Most numbers of a motion are short decimals such as `-12.345678`. Their digits are one whole number
//! below 2⁵³, which a double holds exactly, and so is the power of ten below them: one division rounds
//! once, which is what correct rounding asks for. Eight digits are found and converted at a time in
//! one 64-bit word. Everything else goes to a general parser.

use crate::cursor::is_space;

/// `b'0'` in every byte.
const ZEROS: u64 = 0x3030_3030_3030_3030;
/// The highest bit of every byte.
const HIGH_BITS: u64 = 0x8080_8080_8080_8080;
/// Added to a byte, lifts 10 and more, but no digit, to the highest bit.
const LIFT: u64 = 0x7676_7676_7676_7676;
/// Doubles hold every whole number below this.
const EXACT: u64 = 1 << 53;
/// Powers of ten that doubles hold exactly, as far as sixteen decimals need them.
const POWERS: [f64; 17] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
];
/// The same as whole numbers, as far as one word of decimals needs them.
const WHOLE_POWERS: [u64; 9] = [
    1,
    10,
    100,
    1_000,
    10_000,
    100_000,
    1_000_000,
    10_000_000,
    100_000_000,
];

/// The finite number at `pos` and the place behind it. It must be followed by white space or the end of
/// the text.
#[inline(always)]
pub(crate) fn spaced(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    fixed_point(text, pos).or_else(|| general_spaced(text, pos))
}

/// The finite number at `pos` and the place behind it, whatever follows.
pub(crate) fn longest(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    let (value, n_bytes) = fast_float2::parse_partial::<f64, _>(text.get(pos..)?).ok()?;
    value.is_finite().then_some((value, pos + n_bytes))
}

#[inline(never)]
fn general_spaced(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    longest(text, pos).filter(|&(_, end)| text.get(end).is_none_or(|&b| is_space(b)))
}

/// A decimal of at most seven digits before the point, if it has few enough digits to be exact and
/// does not stand at the very end of the text.
#[inline(always)]
fn fixed_point(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    let head = word(text, pos)?;
    let negative = u64::from(head as u8 == b'-');
    // The zero byte that comes in at the top is no digit, so that the digits end there at the latest.
    let head = (head >> (8 * negative)) ^ ZEROS;
    let n_whole = leading_digits(head);
    if n_whole > 7 {
        return None;
    }
    let whole = first_digits(head, n_whole);
    let mut end = pos + negative as usize + n_whole;
    let mut digits = whole;
    let mut n_decimals = 0;
    if *text.get(end)? == b'.' {
        let tail = word(text, end + 1)? ^ ZEROS;
        n_decimals = leading_digits(tail);
        end += 1 + n_decimals;
        if n_decimals == 8 {
            let more = word(text, end)? ^ ZEROS;
            let n_more = leading_digits(more);
            if n_whole + 8 + n_more > 16 || n_more == 8 {
                return None;
            }
            digits = whole * WHOLE_POWERS[8] + eight_digits(tail);
            digits = digits * WHOLE_POWERS[n_more] + first_digits(more, n_more);
            if digits >= EXACT {
                return None;
            }
            n_decimals += n_more;
            end += n_more;
        } else {
            digits = whole * WHOLE_POWERS[n_decimals] + first_digits(tail, n_decimals);
        }
    }
    let next = *text.get(end)?;
    if n_whole + n_decimals == 0 || !(next == b' ' || is_space(next)) {
        return None;
    }
    // Signed conversion is one instruction, and the number is far below the sign bit.
    let magnitude = digits as i64 as f64 / POWERS[n_decimals];
    let value = f64::from_bits(magnitude.to_bits() | (negative << 63));
    Some((value, end))
}

/// The eight bytes at `pos`, the first one lowest.
#[inline(always)]
fn word(text: &[u8], pos: usize) -> Option<u64> {
    let bytes = text.get(pos..)?.first_chunk::<8>()?;
    Some(u64::from_le_bytes(*bytes))
}

/// How many bytes are 0 to 9 before the first that is not.
#[inline(always)]
fn leading_digits(word: u64) -> usize {
    // A carry can only reach bytes behind the first one that is no digit.
    let others = (word.wrapping_add(LIFT) | word) & HIGH_BITS;
    (others.trailing_zeros() / 8) as usize
}

/// The number that the first `n` bytes are, at most seven.
#[inline(always)]
fn first_digits(word: u64, n: usize) -> u64 {
    // As many zeros come in before them. Two steps, since one by 64 bits is none.
    eight_digits((word << 8) << (56 - 8 * n))
}

/// The number that eight bytes from 0 to 9 are: pairs, then fours, then all, each in one step.
#[inline(always)]
fn eight_digits(word: u64) -> u64 {
    const PAIRS: u64 = 0x0000_00ff_0000_00ff;
    const HUNDRED_AND_MILLION: u64 = 100 + (1_000_000 << 32);
    const ONE_AND_TEN_THOUSAND: u64 = 1 + (10_000 << 32);
    let pairs = word.wrapping_mul(10).wrapping_add(word >> 8);
    let odd = (pairs & PAIRS).wrapping_mul(HUNDRED_AND_MILLION);
    let even = ((pairs >> 16) & PAIRS).wrapping_mul(ONE_AND_TEN_THOUSAND);
    odd.wrapping_add(even) >> 32
}

/// Makes room for `n` more values, and for as many as `n_rest` bytes will likely give after `n_read`
/// bytes gave those that are there, but for no more than `max` in all unless `n` needs it. Growing by
/// doubling would take more memory than files of short numbers may cost.
pub(crate) fn reserve(values: &mut Vec<f64>, n: usize, n_read: usize, n_rest: usize, max: usize) {
    /// Part of what is there that is added at least, so that growing takes linear time.
    const MIN_GROWTH: usize = 8;
    /// Part of the guess that is added to it, so that it seldom falls short by a little.
    const MARGIN: f64 = 1.0 / 16.0;
    let len = values.len();
    if values.capacity() - len >= n {
        return;
    }
    let per_byte = len as f64 / n_read.max(1) as f64;
    let n_likely = (n_rest as f64 * per_byte * (1.0 + MARGIN)) as usize + n;
    let n_wanted = n_likely.max(len / MIN_GROWTH);
    values.reserve_exact(n_wanted.min(max.saturating_sub(len)).max(n));
}

#[cfg(test)]
mod tests;
