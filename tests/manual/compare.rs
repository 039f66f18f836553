//! Does the program print what the manual shows?
//!
//! Lines are compared word by word; runs of blanks are one. Two numbers agree if they differ by at most
//! 1e-6 of the larger one, which is the last of the seven digits that the program shows, or by 1e-12:
//! functions of the system's library may round differently. `...` alone on a line stands for any
//! number of lines. Numbers of a line that tells times, memory or threads are those of the machine:
//! there only the words count. `...` at the end of a line stands for its rest.

const RELATIVE: f64 = 1e-6;
const ABSOLUTE: f64 = 1e-12;

/// Words of lines whose numbers belong to the machine.
const OF_THE_MACHINE: [&str; 9] = [
    "Loop time of",
    "Performance:",
    "Total wall time:",
    "memory",
    "Mbytes",
    "bytes per particle",
    "threads",
    "CPU s",
    " %", // the table of times
];

/// A line in words and numbers.
fn parts(line: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers) = (String::new(), Vec::new());
    for word in line.replace(',', " , ").split_whitespace() {
        let bare = word.trim_matches(|c: char| "():;".contains(c));
        match bare.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                words.push_str(&word.replace(bare, "#"));
                numbers.push(number);
            }
            _ => words.push_str(word),
        }
        words.push(' ');
    }
    (words, numbers)
}

fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= f64::max(RELATIVE * a.abs().max(b.abs()), ABSOLUTE)
}

fn line_agrees(expected: &str, found: &str) -> bool {
    let (expected, found) = match expected.strip_suffix("...") {
        Some(shown) => {
            let count = shown.split_whitespace().count();
            let words: Vec<&str> = found.split_whitespace().take(count).collect();
            (shown, words.join(" "))
        }
        None => (expected, found.to_string()),
    };
    let ((words, numbers), (other_words, others)) = (parts(expected), parts(&found));
    let of_the_machine = OF_THE_MACHINE.iter().any(|mark| expected.contains(mark));
    let agree = || numbers.iter().zip(&others).all(|(a, b)| close(*a, *b));
    words == other_words && (of_the_machine || agree())
}

fn agrees(expected: &[&str], found: &[&str]) -> bool {
    match expected {
        [] => found.is_empty(),
        ["...", rest @ ..] => (0..=found.len()).any(|skip| agrees(rest, &found[skip..])),
        [line, rest @ ..] => match found {
            [first, others @ ..] => line_agrees(line, first) && agrees(rest, others),
            [] => false,
        },
    }
}

/// Compares what a page shows with what was printed; trailing blanks and empty lines at the end are
/// nothing.
///
/// # Errors
/// Both texts.
pub fn compare(expected: &str, found: &str) -> Result<(), String> {
    fn lines(text: &str) -> Vec<&str> {
        text.trim_end().lines().map(str::trim_end).collect()
    }
    if agrees(&lines(expected), &lines(found)) {
        return Ok(());
    }
    Err(format!("expected:\n{}\nfound:\n{}", expected.trim_end(), found.trim_end()))
}

#[test]
fn equal_texts_agree_and_others_do_not() {
    let shown = "a 1 0.5\n...\nEk = 2.6000001\nLoop time of 2.5 on 1 procs\n";
    let printed = "a  1 0.5\nmore\n\nEk = 2.6000002\nLoop time of 0.01 on 1 procs\n\n";
    compare(shown, printed).unwrap();
    for (right, wrong) in
        [("0.5", "0.6"), ("a ", "b "), ("2.6000002", "2.60001"), ("procs", "cores")]
    {
        assert!(compare(shown, &printed.replacen(right, wrong, 1)).is_err(), "{wrong}");
    }
    assert!(compare(shown, &format!("{printed}one more\n")).is_err());
    compare("a 1 ...", "a 1 2 3").unwrap();
    assert!(compare("a 2 ...", "a 1 2 3").is_err());
    assert!(compare("(4 files)", "(5 files)").is_err());
    assert!(compare("dump.50.gz", "dump.51.gz").is_err());
}
