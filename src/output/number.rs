//! Numbers as text: the shortest decimals that read back to the same f64.

/// Appends a number: `0`, `-0.4525`, `1e-300`; what is not finite as `nan`, `inf`, `-inf`.
pub fn push(text: &mut Vec<u8>, value: f64) {
    if value.is_finite() {
        let mut buffer = zmij::Buffer::new();
        let digits = buffer.format_finite(value);
        text.extend_from_slice(digits.strip_suffix(".0").unwrap_or(digits).as_bytes());
    } else if value.is_nan() {
        text.extend_from_slice(b"nan");
    } else {
        text.extend_from_slice(if value > 0.0 { b"inf" } else { b"-inf" });
    }
}

/// Appends a whole number.
pub fn push_integer(text: &mut Vec<u8>, value: u64) {
    text.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

/// A number as a string of its own.
pub fn text(value: f64) -> String {
    let mut bytes = Vec::new();
    push(&mut bytes, value);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A number with seven significant digits, for people.
pub fn brief(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || !value.is_finite() {
        return text(value);
    }
    if (1e-4..1e7).contains(&size) {
        let digits = (6 - size.log10().floor() as i32).max(0) as usize;
        let fixed = format!("{value:.digits$}");
        if !fixed.contains('.') {
            return fixed;
        }
        return fixed.trim_end_matches('0').trim_end_matches('.').to_string();
    }
    format!("{value:.6e}")
}

/// A number of a scale: as few digits as it has among the first five.
pub fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        return brief(format!("{value:.4e}").parse().unwrap_or(value));
    }
    let digits = format!("{value:.4e}");
    match digits.split_once('e') {
        Some((mantissa, power)) if mantissa.contains('.') => {
            format!("{}e{power}", mantissa.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => digits,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn usual_numbers_look_usual() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.4525, "-0.4525"),
            (416.0, "416"),
            (1e-300, "1e-300"),
            (f64::NAN, "nan"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(text(value), expected);
        }
    }

    #[test]
    fn brief_numbers_have_seven_digits() {
        for (value, expected) in [
            (2.6, "2.6"),
            (1234567.89, "1234568"),
            (0.00012345678, "0.0001234568"),
            (1e-9, "1.000000e-9"),
        ] {
            assert_eq!(brief(value), expected);
        }
    }

    #[test]
    fn numbers_of_a_scale_are_short() {
        for (value, expected) in [
            (0.30000000000000004, "0.3"),
            (2e8, "2e8"),
            (-1.5e-5, "-1.5e-5"),
            (0.0, "0"),
            (400.0, "400"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(value), expected);
        }
    }

    proptest! {
        #[test]
        fn every_number_reads_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(text(value).parse::<f64>().unwrap().to_bits(), bits);
        }
    }
}
