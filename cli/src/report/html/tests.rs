use std::collections::BTreeMap;
use std::path::Path;

use walkdir::WalkDir;

use super::*;

/// What the whole page may take, in bytes.
const MOST_BYTES: usize = 80_000;

#[test]
fn every_file_of_the_page_is_inlined() {
    let web = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
    let files = WalkDir::new(&web).into_iter().map(Result::unwrap);
    let files =
        files.filter(|f| f.file_type().is_file() && !f.path().starts_with(web.join("tests")));
    let mut found: Vec<String> = files
        .map(|f| f.path().strip_prefix(&web).unwrap().display().to_string())
        .collect();
    found.sort();
    let mut listed: Vec<&str> = MODULES.iter().map(|(path, _)| *path).collect();
    listed.extend(["index.html", "style.css"]);
    listed.sort_unstable();
    assert_eq!(found, listed);
}

#[test]
fn the_page_is_small() {
    let modules: usize = MODULES.iter().map(|(_, text)| text.len()).sum();
    let total = modules + INDEX.len() + STYLE.len();
    assert!(total <= MOST_BYTES, "{total} bytes");
}

#[test]
fn the_template_has_each_placeholder_once() {
    for name in ["CSP", "TITLE", "STYLE", "SCRIPT", "DOCUMENT"] {
        assert_eq!(
            INDEX.matches(&format!("<!--{name}-->")).count(),
            1,
            "{name}"
        );
    }
    assert_eq!(INDEX.matches("<!--").count(), 5);
}

#[test]
fn the_page_has_no_way_out() {
    for text in MODULES.iter().map(|(_, text)| *text).chain([INDEX, STYLE]) {
        for address in ["http://", "https://", "url(", "@import"] {
            let outside = text.lines().find(|line| line.contains(address));
            // The name of a namespace is no address to load from.
            let outside = outside.filter(|line| !line.contains("http://www.w3.org/"));
            assert_eq!(outside, None);
        }
    }
    assert!(!script().contains("</script") && !script().contains("<!--"));
    assert!(!STYLE.contains("</style"));
    assert!(!script().contains("eval(") && !script().contains("new Function"));
}

/// The names that a line `import {a, b} from './x.js';` brings, and where from.
fn import(line: &str) -> Option<(Vec<&str>, &str)> {
    let inner = line.strip_prefix("import {")?;
    let (names, from) = inner.split_once("} from '")?;
    let names = names.split(',').map(str::trim).collect();
    Some((names, from.strip_suffix("';")?))
}

/// The names that a line at the outermost level declares, one by one or as a list.
fn declared(line: &str) -> Vec<&str> {
    let line = line.strip_prefix("export ").unwrap_or(line);
    let line = line.strip_prefix("async ").unwrap_or(line);
    let kinds = [
        "function* ",
        "function ",
        "class ",
        "const ",
        "let ",
        "var ",
    ];
    let Some(rest) = kinds.iter().find_map(|kind| line.strip_prefix(kind)) else {
        return Vec::new();
    };
    if let Some(list) = rest.strip_prefix(['[', '{']) {
        let list = list.split_once([']', '}']).map_or(list, |(list, _)| list);
        return list.split(',').map(str::trim).collect();
    }
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_' && c != '$');
    vec![&rest[..end.unwrap_or(rest.len())]]
}

#[test]
fn modules_can_be_joined() {
    let mut owners: BTreeMap<&str, &str> = BTreeMap::new();
    let mut exported: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for &(path, text) in MODULES {
        for line in text.lines() {
            if line.trim_start().starts_with("import") && !line.starts_with("import(") {
                let (names, from) = import(line).unwrap_or_else(|| panic!("{path}: {line}"));
                let folder = Path::new(path).parent().unwrap();
                let from = match from.strip_prefix("../") {
                    Some(above) => above.to_owned(),
                    None => folder
                        .join(from.strip_prefix("./").unwrap())
                        .display()
                        .to_string(),
                };
                // Those of a module behind this one are not there yet.
                let there = exported.get(from.as_str());
                let there = there.unwrap_or_else(|| panic!("{path} imports {from} too early"));
                for name in names {
                    assert!(there.contains(&name), "{path}: {from} has no {name}");
                }
            }
            let names = declared(line);
            if line.starts_with("export ") {
                assert!(!names.is_empty(), "{path}: {line}");
                exported.entry(path).or_default().extend(&names);
            }
            for name in names {
                assert!(!name.is_empty(), "{path}: {line}");
                let other = owners.insert(name, path);
                assert_eq!(other, None, "{name} of {path} is another module's, too");
            }
            assert!(!line.starts_with("await "), "{path}: {line}");
        }
        exported.entry(path).or_default();
    }
}

#[test]
fn a_name_cannot_leave_its_place() {
    let evil = "</script><script>alert(1)</script><!--SCRIPT-->\u{2028}\"'&";
    let document = Document {
        title: evil.to_owned(),
        ..Document::default()
    };
    let html = page(&document);
    assert!(!html.contains("</script><script>alert"));
    assert!(!html.contains("<script>"));
    assert_eq!(html.matches("</script>").count(), 2);
    let title = html.split_once("<title>").unwrap().1.split_once("</title>");
    assert_eq!(title.unwrap().0, escaped(evil));
    let inlined = html.split_once("id=\"document\">").unwrap().1;
    let inlined = inlined.split_once("</script>").unwrap().0;
    let back: serde_json::Value = serde_json::from_str(inlined).unwrap();
    assert_eq!(back["title"], evil);
}

#[test]
fn the_policy_allows_the_script_that_stands_there() {
    let html = page(&Document::default());
    let inlined = html.split_once("<script type=\"module\">").unwrap().1;
    let inlined = inlined.split_once("</script>").unwrap().0;
    let policy = content_security_policy(false);
    assert!(policy.contains(&source_hash(inlined)));
    assert!(html.contains(&policy) && !policy.contains("connect-src"));
    assert!(content_security_policy(true).contains("connect-src 'self'"));
    let style = html.split_once("<style>").unwrap().1.split_once("</style>");
    assert!(policy.contains(&source_hash(style.unwrap().0)));
    // Of the empty text, as FIPS 180 examples have it: e3b0c442 98fc1c14 …
    assert_eq!(
        source_hash(""),
        "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU="
    );
}
