//! Labelled spans as a file of ELAN, the annotation program of the MPI for Psycholinguistics (EAF 3.0).

use std::io::{self, Write};
use std::ops::Range;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

/// Annotations under one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Tier {
    /// The name; ELAN wants each to be another.
    pub name: String,
    /// Spans in seconds with what is said of them, in any order.
    pub spans: Vec<(Range<f64>, String)>,
}

/// Files have to say when they were made; ours are the same whenever that is.
const DATE: &str = "1970-01-01T00:00:00Z";

const SCHEMA: &str = "http://www.mpi.nl/tools/elan/EAFv3.0.xsd";

/// Writes tiers. Times are rounded to milliseconds. Spans of a tier must not overlap in ELAN: what
/// does goes to a further tier, `name (2)` and so on.
///
/// # Errors
/// Those of `out`.
pub fn write_eaf(tiers: &[Tier], out: impl Write) -> io::Result<()> {
    let rows: Vec<Row<'_>> = tiers.iter().flat_map(rows).collect();
    let mut times: Vec<u64> = rows.iter().flat_map(Row::times).collect();
    times.sort_unstable();
    times.dedup();
    let n_spans: usize = rows.iter().map(|row| row.spans.len()).sum();
    let mut xml = Writer::new_with_indent(out, b' ', 4);
    xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let document = xml.create_element("ANNOTATION_DOCUMENT").with_attributes([
        ("AUTHOR", "motif"),
        ("DATE", DATE),
        ("FORMAT", "3.0"),
        ("VERSION", "3.0"),
        ("xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance"),
        ("xsi:noNamespaceSchemaLocation", SCHEMA),
    ]);
    document.write_inner_content(|xml| {
        let header = xml.create_element("HEADER");
        let header = header.with_attributes([("MEDIA_FILE", ""), ("TIME_UNITS", "milliseconds")]);
        header.write_inner_content(|xml| {
            let last = xml.create_element("PROPERTY");
            let last = last.with_attribute(("NAME", "lastUsedAnnotationId"));
            last.write_text_content(BytesText::new(&n_spans.to_string()))?;
            Ok(())
        })?;
        xml.create_element("TIME_ORDER")
            .write_inner_content(|xml| {
                for time in &times {
                    let slot = xml.create_element("TIME_SLOT");
                    let id = ("TIME_SLOT_ID", slot_of(&times, *time));
                    let value = ("TIME_VALUE", time.to_string());
                    slot.with_attributes([id, value].each_ref().map(|(k, v)| (*k, v.as_str())))
                        .write_empty()?;
                }
                Ok(())
            })?;
        let mut n_written = 0;
        for row in &rows {
            let tier = xml.create_element("TIER").with_attributes([
                ("LINGUISTIC_TYPE_REF", "motion"),
                ("TIER_ID", row.name.as_str()),
            ]);
            tier.write_inner_content(|xml| {
                for (span, value) in &row.spans {
                    n_written += 1;
                    write_annotation(xml, n_written, &times, span, value)?;
                }
                Ok(())
            })?;
        }
        let kind = xml.create_element("LINGUISTIC_TYPE").with_attributes([
            ("GRAPHIC_REFERENCES", "false"),
            ("LINGUISTIC_TYPE_ID", "motion"),
            ("TIME_ALIGNABLE", "true"),
        ]);
        kind.write_empty()?;
        Ok(())
    })?;
    writeln!(xml.into_inner())
}

fn write_annotation<W: Write>(
    xml: &mut Writer<W>,
    number: usize,
    times: &[u64],
    span: &Range<u64>,
    value: &str,
) -> io::Result<()> {
    xml.create_element("ANNOTATION")
        .write_inner_content(|xml| {
            let attributes = [
                ("ANNOTATION_ID", format!("a{number}")),
                ("TIME_SLOT_REF1", slot_of(times, span.start)),
                ("TIME_SLOT_REF2", slot_of(times, span.end)),
            ];
            let annotation = xml.create_element("ALIGNABLE_ANNOTATION");
            annotation
                .with_attributes(attributes.each_ref().map(|(k, v)| (*k, v.as_str())))
                .write_inner_content(|xml| {
                    let element = xml.create_element("ANNOTATION_VALUE");
                    element.write_text_content(BytesText::new(value))?;
                    Ok(())
                })?;
            Ok(())
        })?;
    Ok(())
}

fn slot_of(times: &[u64], time: u64) -> String {
    format!("ts{}", times.partition_point(|&t| t < time) + 1)
}

/// Spans in milliseconds that follow each other.
struct Row<'a> {
    name: String,
    spans: Vec<(Range<u64>, &'a str)>,
}

impl Row<'_> {
    fn times(&self) -> impl Iterator<Item = u64> + '_ {
        let ends = self.spans.iter();
        ends.flat_map(|(span, _)| [span.start, span.end])
    }
}

/// Spreads a tier's spans over as few rows as it takes.
fn rows(tier: &Tier) -> Vec<Row<'_>> {
    let milliseconds = |seconds: f64| (seconds * 1000.0).round() as u64;
    let mut spans: Vec<(Range<u64>, &str)> = tier
        .spans
        .iter()
        .map(|(span, value)| {
            let start = milliseconds(span.start);
            // An annotation without length cannot be seen.
            (start..milliseconds(span.end).max(start + 1), value.as_str())
        })
        .collect();
    spans.sort_by_key(|(span, _)| (span.start, span.end));
    let mut rows: Vec<Row<'_>> = Vec::new();
    for (span, value) in spans {
        let is_free = |row: &Row<'_>| {
            row.spans
                .last()
                .is_none_or(|(last, _)| last.end <= span.start)
        };
        let row = match rows.iter().position(is_free) {
            Some(row) => row,
            None => {
                let name = match rows.len() {
                    0 => tier.name.clone(),
                    n => format!("{} ({})", tier.name, n + 1),
                };
                rows.push(Row {
                    name,
                    spans: Vec::new(),
                });
                rows.len() - 1
            }
        };
        rows[row].spans.push((span, value));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlapping_spans_stand_in_rows_of_their_own() {
        let tier = Tier {
            name: "kick & <punch>".to_owned(),
            spans: vec![
                (1.0..2.0, "a".to_owned()),
                (0.0..1.0, "b".to_owned()),
                (1.5..1.75, "c".to_owned()),
            ],
        };
        let rows = rows(&tier);
        let names: Vec<&str> = rows.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(names, ["kick & <punch>", "kick & <punch> (2)"]);
        assert_eq!(rows[0].spans, [(0..1000, "b"), (1000..2000, "a")]);
        assert_eq!(rows[1].spans, [(1500..1750, "c")]);
    }

    #[test]
    fn files_are_xml_whatever_labels_are_called() {
        let tier = Tier {
            name: "kick & \"<punch>\"".to_owned(),
            spans: vec![(0.5..1.25, "a < b".to_owned())],
        };
        let mut out = Vec::new();
        write_eaf(&[tier], &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let mut reader = quick_xml::Reader::from_str(&text);
        let mut names = Vec::new();
        let mut values = Vec::new();
        loop {
            match reader.read_event().unwrap() {
                Event::Eof => break,
                Event::Start(element) if element.name().as_ref() == "TIER" => {
                    let id = element.try_get_attribute("TIER_ID").unwrap().unwrap();
                    names.push(
                        id.normalized_value(quick_xml::XmlVersion::Implicit1_0)
                            .unwrap()
                            .into_owned(),
                    );
                }
                Event::Empty(element) if element.name().as_ref() == "TIME_SLOT" => {
                    let time = element.try_get_attribute("TIME_VALUE").unwrap().unwrap();
                    values.push(
                        time.normalized_value(quick_xml::XmlVersion::Implicit1_0)
                            .unwrap()
                            .into_owned(),
                    );
                }
                _ => {}
            }
        }
        assert_eq!(names, ["kick & \"<punch>\""]);
        assert_eq!(values, ["500", "1250"]);
        assert!(
            text.contains("<ANNOTATION_VALUE>a &lt; b</ANNOTATION_VALUE>"),
            "{text}"
        );
    }
}
