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
/// The first byte that is neither white space nor a control character, in every byte.
const PRINTABLE: u64 = 0x2121_2121_2121_2121;
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
    short_decimal(text, pos).or_else(|| uncommon(text, pos))
}

/// The finite number at `pos` and the place behind it, whatever follows.
pub(crate) fn longest(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    let (value, n_bytes) = fast_float2::parse_partial::<f64, _>(text.get(pos..)?).ok()?;
    value.is_finite().then_some((value, pos + n_bytes))
}

#[inline(never)]
fn uncommon(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    let is_end = |end: usize| text.get(end).is_none_or(|&b| is_space(b));
    long_decimal(text, pos).or_else(|| longest(text, pos).filter(|&(_, end)| is_end(end)))
}

/// A decimal of at most seven digits before and seven behind the point, as nearly all are.
///
/// Where it ends is found first, from its bytes alone, and only compared with where its digits end: so
/// the processor can begin with the next number while it is still busy with this one.
#[inline(always)]
pub(crate) fn short_decimal(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    let window: &[u8; WINDOW] = text.get(pos..)?.first_chunk()?;
    let head = word_at(window, 0);
    let len = first_space(head, word_at(window, 8));
    let negative = usize::from(head as u8 == b'-');
    // The zero byte that comes in at the top is no digit, so that the digits end there at the latest.
    let head = (head >> (8 * negative)) ^ ZEROS;
    let n_whole = leading_digits(head);
    if n_whole > 7 {
        return None;
    }
    let mut digits = first_digits(head, n_whole);
    let mut n_decimals = 0;
    let mut end = negative + n_whole;
    if window[end & 15] == b'.' {
        let tail = word_at(window, end + 1) ^ ZEROS;
        n_decimals = leading_digits(tail);
        if n_decimals > 7 {
            return None;
        }
        digits = digits * WHOLE_POWERS[n_decimals & 7] + first_digits(tail, n_decimals);
        end += 1 + n_decimals;
    }
    if end != len || n_whole + n_decimals == 0 || !is_space(window[len & 31]) {
        return None;
    }
    let value = signed_quotient(digits, n_decimals & 7, negative != 0);
    Some((value, pos + len))
}

/// Bytes of which [`short_decimal`] looks at some: a sign, seven digits, a point, and eight digits of
/// which seven may be.
const WINDOW: usize = 32;

#[inline(always)]
fn word_at(window: &[u8; WINDOW], at: usize) -> u64 {
    // Never more than 9, which the compiler need not find out.
    let at = at & 15;
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&window[at..at + 8]);
    u64::from_le_bytes(bytes)
}

/// How many of sixteen bytes come before the first that is white space or a control character.
#[inline(always)]
fn first_space(low: u64, high: u64) -> usize {
    // A borrow can only reach bytes behind the first one below.
    let below = |word: u64| u128::from(word.wrapping_sub(PRINTABLE) & !word & HIGH_BITS);
    ((below(high) << 64 | below(low)).trailing_zeros() / 8) as usize
}

/// `digits` · 10^-`n_decimals`, exactly rounded if `digits` is exact.
#[inline(always)]
fn signed_quotient(digits: u64, n_decimals: usize, negative: bool) -> f64 {
    // Signed conversion is one instruction, and the number is far below the sign bit.
    let magnitude = digits as i64 as f64 / POWERS[n_decimals];
    f64::from_bits(magnitude.to_bits() | (u64::from(negative) << 63))
}

/// A decimal of at most sixteen digits, seven of them before the point and at least eight behind it.
fn long_decimal(text: &[u8], pos: usize) -> Option<(f64, usize)> {
    let negative = text.get(pos) == Some(&b'-');
    let whole_at = pos + usize::from(negative);
    let head = word(text, whole_at)? ^ ZEROS;
    let n_whole = leading_digits(head);
    if n_whole > 7 || text.get(whole_at + n_whole) != Some(&b'.') {
        return None;
    }
    let mut end = whole_at + n_whole + 1;
    let tail = word(text, end)? ^ ZEROS;
    let more = word(text, end + 8)? ^ ZEROS;
    let n_more = leading_digits(more);
    if leading_digits(tail) < 8 || n_whole + 8 + n_more > 16 || n_more == 8 {
        return None;
    }
    end += 8 + n_more;
    let digits = first_digits(head, n_whole) * WHOLE_POWERS[8] + eight_digits(tail);
    let digits = digits * WHOLE_POWERS[n_more] + first_digits(more, n_more);
    let is_number = digits < EXACT && text.get(end).is_some_and(|&b| is_space(b));
    is_number.then(|| (signed_quotient(digits, 8 + n_more, negative), end))
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
