//! Links, the table of contents, the reference and quotations.

use super::compare::compare;
use super::page::Page;
use super::{files, pages, root};
use assert_cmd::cargo::cargo_bin;
use std::path::Path;
use std::process::Command;

/// Why a link of a page leads nowhere.
fn broken(page: &Page, target: &str) -> Option<String> {
    if target.contains("://") {
        return None; // not ours to keep
    }
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let file = match path {
        "" => page.path.clone(),
        path => page.path.parent()?.join(path),
    };
    if !file.exists() {
        return Some("no such file".into());
    }
    if anchor.is_empty() {
        return None;
    }
    let known = Page::read(&file).anchors;
    (!known.iter().any(|known| known == anchor)).then(|| format!("no heading `{anchor}` there"))
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for page in pages() {
        for link in &page.links {
            count += 1;
            if let Some(why) = broken(&page, &link.target) {
                wrong.push(format!(
                    "{}:{}: {}: {why}",
                    page.path.display(),
                    link.line,
                    link.target
                ));
            }
        }
    }
    assert!(count > 100, "the test reads the pages: {count}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn links_inside_the_manual_stay_inside() {
    // mdBook copies docs/src alone: what lies beside it is linked by its address, if at all.
    let book = root().join("docs/src").canonicalize().unwrap();
    for page in pages().iter().filter(|page| page.path.starts_with(&book)) {
        for link in page.links.iter().filter(|link| !link.target.contains("://")) {
            let path = link.target.split('#').next().unwrap_or_default();
            let file = page.path.parent().unwrap().join(path).canonicalize();
            let inside = file.is_ok_and(|file| file.starts_with(&book));
            assert!(inside, "{}:{}: {}", page.path.display(), link.line, link.target);
            // The book calls it index.html, and does not change links to it.
            let home = path.ends_with("README.md") && !page.path.ends_with("SUMMARY.md");
            assert!(!home, "{}:{}: {}", page.path.display(), link.line, link.target);
        }
    }
}

#[test]
fn a_broken_link_and_a_broken_anchor_are_seen() {
    let here = root().join("docs/src/SUMMARY.md");
    let page = Page::read(&here);
    assert!(broken(&page, "nowhere.md").is_some());
    assert!(broken(&page, "#two").is_some());
    assert!(broken(&page, "#summary").is_none());
}

#[test]
fn the_table_of_contents_names_every_page_once() {
    let book = root().join("docs/src");
    let summary = Page::read(&book.join("SUMMARY.md"));
    for path in files(&book, "md") {
        let name = path.strip_prefix(&book).unwrap().display().to_string();
        let times = summary.links.iter().filter(|link| link.target == name).count();
        assert_eq!(times, usize::from(name != "SUMMARY.md"), "{name}");
    }
}

#[test]
fn the_reference_is_what_the_program_says() {
    let place = tempfile::tempdir().unwrap();
    let mut command = Command::new(cargo_bin!("karamelo-rs"));
    let output = command.args(["styles", "--markdown"]).arg(place.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let committed = root().join("docs/src/reference");
    let names = |folder: &Path| {
        let name = |path: &std::path::PathBuf| path.file_name().unwrap().to_os_string();
        files(folder, "md").iter().map(name).collect::<Vec<_>>()
    };
    let how = "run `cargo run -- styles --markdown docs/src/reference`";
    assert_eq!(names(place.path()), names(&committed), "{how}");
    for name in names(&committed) {
        let [now, then] = [place.path(), &committed]
            .map(|folder| std::fs::read_to_string(folder.join(&name)).unwrap());
        assert!(now == then, "docs/src/reference/{} is old: {how}", name.display());
    }
}

#[test]
fn quotations_stand_in_the_files_they_name() {
    let mut count = 0;
    for page in pages() {
        for block in &page.blocks {
            let Some(from) = block.value("from") else { continue };
            let text = std::fs::read_to_string(root().join(from)).unwrap();
            let place = format!("{}:{}", page.path.display(), block.line);
            // `...` alone on a line leaves lines out.
            for part in block.text.split("...\n") {
                assert!(text.contains(part.trim_matches('\n')), "{place}: {from} has no\n{part}");
            }
            count += 1;
        }
    }
    assert!(count > 3, "the test reads the pages: {count}");
}

#[allow(dead_code)] // its `main`
#[path = "../../examples/new_law.rs"]
mod new_law;

#[test]
fn the_law_of_the_manual_is_a_law() {
    let chapter = Page::read(&root().join("docs/src/adding-a-law.md"));
    let shown = chapter.blocks.iter().find(|block| block.value("run") == Some("new_law")).unwrap();
    compare(&shown.text, &new_law::report().unwrap()).unwrap();
}
