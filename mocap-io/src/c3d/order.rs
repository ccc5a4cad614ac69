use std::fmt;

/// How a C3D file writes its numbers: the processor it was made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ByteOrder {
    /// Little endian, IEEE 754.
    Intel,
    /// Little endian, floating point as on a VAX or PDP-11 (F format).
    Dec,
    /// Big endian, IEEE 754; also called SGI.
    Mips,
}

impl ByteOrder {
    pub(super) const ALL: [ByteOrder; 3] = [ByteOrder::Intel, ByteOrder::Dec, ByteOrder::Mips];

    /// The byte that stands for this order in the parameter section: 83 + processor type.
    pub(super) fn processor(self) -> u8 {
        match self {
            ByteOrder::Intel => 84,
            ByteOrder::Dec => 85,
            ByteOrder::Mips => 86,
        }
    }

    pub(super) fn u16(self, bytes: [u8; 2]) -> u16 {
        match self {
            ByteOrder::Intel | ByteOrder::Dec => u16::from_le_bytes(bytes),
            ByteOrder::Mips => u16::from_be_bytes(bytes),
        }
    }

    pub(super) fn f32(self, bytes: [u8; 4]) -> f32 {
        match self {
            ByteOrder::Intel => f32::from_le_bytes(bytes),
            ByteOrder::Dec => dec_f32(bytes),
            ByteOrder::Mips => f32::from_be_bytes(bytes),
        }
    }
}

impl fmt::Display for ByteOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ByteOrder::Intel => "Intel",
            ByteOrder::Dec => "DEC",
            ByteOrder::Mips => "MIPS",
        })
    }
}

/// How points and analog samples are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Storage {
    /// 16-bit integers, times POINT:SCALE.
    Integer,
    /// 32-bit floating point.
    Float,
}

impl Storage {
    /// Bytes of one number.
    pub(super) fn size(self) -> usize {
        match self {
            Storage::Integer => 2,
            Storage::Float => 4,
        }
    }
}

impl fmt::Display for Storage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Storage::Integer => "integer",
            Storage::Float => "float",
        })
    }
}

/// VAX F floating: words in little-endian order, the high word first; exponent bias 128 with the
/// mantissa in [0.5, 1), so that the same bits read as IEEE are four times too large. An exponent of
/// zero is zero with a positive sign and a reserved operand, here NaN, with a negative one.
#[inline]
pub(super) fn dec_f32([b0, b1, b2, b3]: [u8; 4]) -> f32 {
    let bits = u32::from_le_bytes([b2, b3, b0, b1]);
    if bits & 0x7f80_0000 == 0 {
        return if bits >> 31 == 0 { 0.0 } else { f32::NAN };
    }
    // IEEE would take the two largest exponents for infinities; as f64 there is room.
    let exponent = (bits >> 23 & 0xff) as i32;
    let mantissa = f64::from(bits & 0x007f_ffff | 0x0080_0000);
    let magnitude = mantissa * f64::from_bits(((exponent - 152 + 1023) as u64) << 52);
    (if bits >> 31 == 0 {
        magnitude
    } else {
        -magnitude
    }) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bit patterns from the VAX architecture's definition: 1.0 is 0x4080 in the first word.
    #[test]
    fn dec_floats_are_read() {
        for (words, value) in [
            ([0x4080u16, 0], 1.0f32),
            ([0xc080, 0], -1.0),
            ([0x4000, 0], 0.5),
            ([0x4100, 0], 2.0),
            ([0x4149, 0x0fdb], std::f32::consts::PI),
            ([0, 0], 0.0),
            ([0x0080, 0], f32::from_bits(0x0020_0000)), // 2^-128, the smallest
            ([0x7fff, 0xffff], 1.701_411_7e38),         // just below 2^127, the largest
        ] {
            let [a, b] = words.map(u16::to_le_bytes);
            assert_eq!(dec_f32([a[0], a[1], b[0], b[1]]), value, "{words:x?}");
        }
        assert!(dec_f32([0, 0x80, 0, 0]).is_nan());
    }
}
