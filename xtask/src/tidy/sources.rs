//! Rules about the text of one file.

use super::{File, Finding};
use crate::rust_text::{self, Line};
use crate::workspace::LIBRARIES;

/// Words that announce unfinished work.
const MARKERS: [&str; 3] = ["TODO", "FIXME", "XXX"];
/// Macros that must not be left behind.
const LEFTOVERS: [&str; 3] = ["todo!", "dbg!", "unimplemented!"];

/// All findings about one file; none for files that are neither source, manifest nor prose.
pub(super) fn check(file: &File) -> Vec<Finding> {
    match file.extension() {
        "rs" => check_rust(file),
        "md" | "toml" => {
            let lines = file.text.lines().enumerate();
            lines
                .filter_map(|(i, line)| Some(marker(line)?.at(file, i + 1)))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// A rule broken somewhere on a line.
struct Broken {
    rule: &'static str,
    message: String,
}

impl Broken {
    fn new(rule: &'static str, message: impl Into<String>) -> Self {
        Self {
            rule,
            message: message.into(),
        }
    }

    fn at(self, file: &File, line: usize) -> Finding {
        Finding {
            path: file.path.clone(),
            line,
            rule: self.rule,
            message: self.message,
        }
    }
}

fn check_rust(file: &File) -> Vec<Finding> {
    let lines = rust_text::split(&file.text);
    let mut may_not_sleep = is_test_path(&file.path) || is_library_path(&file.path);
    let mut findings = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        may_not_sleep |= line.code.contains("#[cfg(test)]");
        let broken = [
            marker(&line.comment),
            leftover(&line.code),
            ignored(&line.code),
            sleep(&line.code).filter(|_| may_not_sleep),
            unexplained_unsafe(&lines, i),
            commented_out(line),
        ];
        findings.extend(
            broken
                .into_iter()
                .flatten()
                .map(|broken| broken.at(file, i + 1)),
        );
    }
    findings
}

fn is_test_path(path: &str) -> bool {
    path.split('/')
        .any(|part| part == "tests" || part == "tests.rs")
}

fn is_library_path(path: &str) -> bool {
    path.split('/')
        .next()
        .is_some_and(|room| LIBRARIES.contains(&room))
}

fn marker(text: &str) -> Option<Broken> {
    let word = words(text).find(|word| MARKERS.contains(word))?;
    Some(Broken::new(
        "marker",
        format!("`{word}`: finish it or file it elsewhere"),
    ))
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

fn leftover(code: &str) -> Option<Broken> {
    let name = LEFTOVERS.into_iter().find(|name| {
        let bare = name.trim_end_matches('!');
        words(code).any(|word| word == bare) && code.contains(name)
    })?;
    Some(Broken::new(
        "leftover",
        format!("`{name}` left in the code"),
    ))
}

fn ignored(code: &str) -> Option<Broken> {
    let attribute: String = code.chars().filter(|c| !c.is_whitespace()).collect();
    let is_ignored = attribute.contains("#[ignore")
        || attribute.contains("#[cfg_attr(") && words(code).any(|word| word == "ignore");
    is_ignored.then(|| Broken::new("ignored-test", "assert today's result instead"))
}

fn sleep(code: &str) -> Option<Broken> {
    let sleeps = code.contains("thread::sleep") || code.contains("time::sleep");
    sleeps.then(|| Broken::new("sleep", "wait for the event itself"))
}

/// `unsafe` without a `SAFETY:` comment on its line or directly above.
fn unexplained_unsafe(lines: &[Line], i: usize) -> Option<Broken> {
    let mut tokens = words(&lines[i].code).filter(|word| !word.is_empty());
    tokens.find(|&word| word == "unsafe")?;
    let next = tokens.next();
    // An `unsafe fn` or trait states its contract in its documentation; the blocks are judged.
    if matches!(next, Some("fn" | "trait" | "extern")) {
        return None;
    }
    let above = lines[..i]
        .iter()
        .rev()
        .take_while(|line| line.code.trim().is_empty() && !line.comment.is_empty());
    let explained = std::iter::once(&lines[i])
        .chain(above)
        .any(|line| line.comment.contains("SAFETY:"));
    (!explained).then(|| Broken::new("unsafe", "no `SAFETY:` comment"))
}

/// A comment that is code. Only unmistakable shapes count, so that prose never does.
fn commented_out(line: &Line) -> Option<Broken> {
    if line.is_doc {
        return None;
    }
    let text = line.comment.trim();
    looks_like_code(text).then(|| Broken::new("commented-out", "delete it; git remembers"))
}

fn looks_like_code(text: &str) -> bool {
    if matches!(text, "}" | "};" | "})" | "});" | "},") {
        return true;
    }
    let first = text.split([' ', '(']).next().unwrap_or_default();
    if text.ends_with('{') {
        const OPENERS: [&str; 14] = [
            "}", "async", "const", "else", "enum", "fn", "for", "if", "impl", "loop", "match",
            "mod", "pub", "struct",
        ];
        return OPENERS.contains(&first) || matches!(first, "trait" | "unsafe" | "while");
    }
    let Some(statement) = text.strip_suffix(';') else {
        return text.starts_with("#[") && text.ends_with(']');
    };
    match first {
        "let" | "const" | "static" => statement.contains(" = "),
        "use" | "pub" => statement.contains("::"),
        "return" | "break" | "continue" => statement.split(' ').count() <= 2,
        _ => is_call(statement) || is_update(statement),
    }
}

/// `path::or.chain(…)`, with nothing but the path before the parenthesis.
fn is_call(statement: &str) -> bool {
    let Some((callee, _)) = statement.split_once('(') else {
        return false;
    };
    let ends = statement.ends_with(')') || statement.ends_with(")?");
    let is_path = |c: char| c.is_alphanumeric() || matches!(c, '_' | ':' | '.' | '!' | '&' | '*');
    ends && !callee.is_empty() && callee.chars().all(is_path)
}

/// `place += …`: no prose has the operator.
fn is_update(statement: &str) -> bool {
    let mut parts = statement.split(' ');
    parts.next().is_some()
        && matches!(
            parts.next(),
            Some("+=" | "-=" | "*=" | "/=" | "|=" | "&=" | "^=")
        )
}

#[cfg(test)]
mod tests {
    use super::super::file;
    use super::*;

    #[track_caller]
    fn findings(path: &str, text: &str, expected: &[(usize, &str)]) {
        let found = check(&file(path, text));
        let found: Vec<(usize, &str)> = found
            .iter()
            .map(|finding| (finding.line, finding.rule))
            .collect();
        assert_eq!(found, expected, "{text}");
    }

    #[test]
    fn markers_are_found_in_comments_manifests_and_prose() {
        findings("a/src/lib.rs", "fn f() {} // TODO: g\n", &[(1, "marker")]);
        findings(
            "a/src/lib.rs",
            "\n/// FIXME\n/* XXX */\n",
            &[(2, "marker"), (3, "marker")],
        );
        findings("a/Cargo.toml", "# TODO pin\n", &[(1, "marker")]);
        findings("README.md", "a\nTODO(me)\n", &[(2, "marker")]);
        findings(
            "a/src/lib.rs",
            "const TODOS: &str = \"TODO\"; // todo list\n",
            &[],
        );
    }

    #[test]
    fn leftovers_are_found_in_code_only() {
        findings(
            "a/src/lib.rs",
            "todo!()\n dbg!(x);\n",
            &[(1, "leftover"), (2, "leftover")],
        );
        findings("a/src/lib.rs", "std::unimplemented!()", &[(1, "leftover")]);
        findings(
            "a/src/lib.rs",
            "my_dbg!(x); f(\"todo!\"); // dbg! is out\n",
            &[],
        );
    }

    #[test]
    fn ignored_tests_are_found() {
        findings(
            "a/src/lib.rs",
            "#[test]\n#[ignore]\n",
            &[(2, "ignored-test")],
        );
        findings(
            "a/src/lib.rs",
            "# [ignore = \"slow\"]",
            &[(1, "ignored-test")],
        );
        findings(
            "a/src/lib.rs",
            "#[cfg_attr(windows, ignore)]",
            &[(1, "ignored-test")],
        );
        findings(
            "a/src/lib.rs",
            "// #[ignore] hides a test\nfn ignore() {}",
            &[],
        );
    }

    #[test]
    fn sleeps_are_found_in_tests_and_libraries() {
        let text = "std::thread::sleep(second);";
        findings("cli/tests/it/view.rs", text, &[(1, "sleep")]);
        findings("dtw/src/lib.rs", text, &[(1, "sleep")]);
        findings("cli/src/view.rs", text, &[]);
        findings(
            "cli/src/view.rs",
            &format!("{text}\n#[cfg(test)]\n{text}"),
            &[(3, "sleep")],
        );
    }

    #[test]
    fn unsafe_blocks_are_explained() {
        findings("a/src/lib.rs", "let x = unsafe { f() };", &[(1, "unsafe")]);
        findings(
            "a/src/lib.rs",
            "// A reason.\nunsafe impl Send for X {}",
            &[(2, "unsafe")],
        );
        findings(
            "a/src/lib.rs",
            "// SAFETY: held,\n// as above.\nunsafe { f() }",
            &[],
        );
        findings("a/src/lib.rs", "unsafe { f() } // SAFETY: held", &[]);
        findings(
            "a/src/lib.rs",
            "pub unsafe fn f() {} // unsafe\n#![forbid(unsafe_code)]",
            &[],
        );
    }

    #[test]
    fn commented_out_code_is_found() {
        for text in [
            "let x = 3;",
            "use std::fs;",
            "return x;",
            "frames.push(pose)?;",
            "println!(\"{x}\");",
            "total += x;",
            "if x == 3 {",
            "} else {",
            "pub fn f(&self) -> usize {",
            "}",
            "});",
            "#[inline]",
        ] {
            findings(
                "a/src/lib.rs",
                &format!("f(); // {text}"),
                &[(1, "commented-out")],
            );
        }
    }

    #[test]
    fn prose_is_no_code() {
        for text in [
            "The band is wide (in cells);",
            "Invariant: prev[j] is D(i - 1, j - 1);",
            "let the caller decide;",
            "use the first one;",
            "return early when there is nothing;",
            "if a frame is missing, the last one stays;",
            "x = 3 here;",
            "D(1, l) = c(1, l) for every l;",
            "A set such as {",
            "Termination: `hi - lo` shrinks.",
        ] {
            findings("a/src/lib.rs", &format!("f(); // {text}"), &[]);
        }
        findings("a/src/lib.rs", "/// let x = 3;\n//! f(x);", &[]);
    }
}
