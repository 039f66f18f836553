//! Some measurements of one quantity.

/// Measurements in the order they were made.
#[derive(Default)]
pub struct Sample(pub Vec<f64>);

impl Sample {
    /// The middle one, or the mean of the two in the middle; NaN of none.
    pub fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        match sorted.len() {
            0 => f64::NAN,
            count => 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]),
        }
    }

    /// Median, smallest and largest, or `-` of none.
    pub fn text(&self, unit: &str) -> String {
        if self.0.is_empty() {
            return "-".to_string();
        }
        let smallest = self.0.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = self.0.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [median, smallest, largest] = [self.median(), smallest, largest].map(brief);
        format!("{median} {unit} ({smallest} - {largest})")
    }
}

/// Three digits.
pub fn brief(value: f64) -> String {
    let before = value.abs().max(1.0).log10() as usize;
    format!("{value:.*}", 2_usize.saturating_sub(before))
}
