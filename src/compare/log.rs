//! Rows of a log file.

use super::{Cell, Table};

/// A table for each run; `None` if it is no log.
pub fn read(bytes: &[u8]) -> Option<Vec<Table>> {
    let text = std::str::from_utf8(bytes).ok()?;
    let mut tables = Vec::new();
    let mut open: Option<Table> = None;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.first() == Some(&"Step") {
            tables.extend(open.take());
            let names = words.iter().map(|word| word.to_string()).collect();
            open = Some(Table { names, ..Table::default() });
        } else if let Some(table) = &mut open {
            match words.first().and_then(|word| word.parse().ok()) {
                Some(step) if words.len() == table.names.len() => {
                    table.keys.push(step);
                    let cell = |word: &&str| match word.parse() {
                        Ok(number) => Cell::Number(number),
                        Err(_) => Cell::Word(word.to_string()),
                    };
                    table.cells.extend(words.iter().map(cell));
                }
                _ => tables.extend(open.take()),
            }
        }
    }
    tables.extend(open);
    (!tables.is_empty()).then_some(tables)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_between_the_header_and_the_loop_time() {
        let text = "karamelo-rs\n   Step   dt  dt_limit\n   0  0.5  acoustic\n  10  0.25  end\n\
            Loop time of 3 s\n 7 8 9\n  Step dt\n 10 0.5\n";
        let tables = read(text.as_bytes()).unwrap();
        assert_eq!(tables.len(), 2);
        assert_eq!((&tables[0].keys[..], &tables[1].keys[..]), (&[0, 10][..], &[10][..]));
        assert_eq!(*tables[0].cell(1, 2), Cell::Word("end".to_string()));
        assert_eq!(read(b"nothing of that kind\n"), None);
    }
}
