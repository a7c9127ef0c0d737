//! Numbers as bits that are sorted like them.

/// Bits that compare, as an unsigned integer, like the number.
#[must_use]
#[inline(always)]
pub fn ordered(position: f32) -> u32 {
    let bits = position.to_bits();
    bits ^ (((bits as i32 >> 31) as u32) | 0x8000_0000)
}

/// The number of which `ordered` gave these bits.
#[must_use]
#[inline(always)]
pub fn position_of(ordered: u32) -> f32 {
    f32::from_bits(ordered ^ (!((ordered as i32 >> 31) as u32) | 0x8000_0000))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordered_bits_compare_like_numbers() {
        let numbers = [f32::MIN, -1.5, -1e-40, 0.0, 1e-40, 1.0, f32::MAX];
        for pair in numbers.windows(2) {
            assert!(ordered(pair[0]) < ordered(pair[1]), "{pair:?}");
        }
        for number in numbers {
            assert_eq!(position_of(ordered(number)).to_bits(), number.to_bits());
        }
    }
}
