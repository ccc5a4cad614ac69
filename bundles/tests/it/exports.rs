use bundles::BundleGraph;
use proptest::prelude::*;
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::{Value, json};

use crate::graph_laws::graph_of;
use crate::mapping_laws::mapped;

/// Of numbers printed in full, read again by a parser that may round down, and divided.
const ROUNDING: f64 = 1e-9;

/// What text formats quote, and more.
const NAMES: [&str; 3] = [
    "a \"b\" <c> & 'd'.amc",
    "e\\f\n\tg\u{1}.bvh",
    "ä ]]> \u{1f600} --",
];

fn spans(graph: &BundleGraph, submotions: &[bundles::Submotion]) -> Vec<Value> {
    let span = |s: &bundles::Submotion| {
        let start = graph.clips()[s.clip].start;
        json!({"clip": NAMES[s.clip], "start": s.span.start - start, "end": s.span.end - start})
    };
    submotions.iter().map(span).collect()
}

/// A name, and attributes.
type Element = (String, Vec<(String, String)>);

/// Elements with their attributes, and all text, unescaped; panics if tags do not match.
fn xml(text: &str) -> (Vec<Element>, Vec<String>) {
    let mut reader = Reader::from_str(text);
    let (mut elements, mut texts, mut open) = (Vec::new(), vec![String::new()], 0_usize);
    loop {
        match reader.read_event().unwrap() {
            Event::Start(tag) => {
                open += 1;
                elements.push(element(&tag));
                texts.push(String::new());
            }
            Event::Empty(tag) => elements.push(element(&tag)),
            Event::End(_) => {
                open -= 1;
                texts.push(String::new());
            }
            Event::Text(text) => texts.last_mut().unwrap().push_str(&text),
            Event::GeneralRef(entity) => {
                let raw = format!("&{};", &*entity);
                let character = quick_xml::escape::unescape(&raw).unwrap();
                texts.last_mut().unwrap().push_str(&character);
            }
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(open, 0);
    (elements, texts)
}

fn element(tag: &quick_xml::events::BytesStart<'_>) -> Element {
    let attributes = tag.attributes().map(|attribute| {
        let attribute = attribute.unwrap();
        let value = quick_xml::escape::unescape(&attribute.value).unwrap();
        (attribute.key.as_ref().to_owned(), value.into_owned())
    });
    (tag.name().as_ref().to_owned(), attributes.collect())
}

/// `name@a-b` of each submotion, as XML can hold it.
fn labels(graph: &BundleGraph, submotions: &[bundles::Submotion]) -> String {
    let spans = spans(graph, submotions);
    let label = |span: &Value| {
        let name = span["clip"].as_str().unwrap();
        format!("{name}@{}-{}", span["start"], span["end"])
    };
    spans.iter().map(label).collect::<Vec<_>>().join(" ")
}

fn number(attributes: &[(String, String)], name: &str) -> f64 {
    let value = attributes.iter().find(|(key, _)| key == name);
    value.unwrap().1.parse().unwrap()
}

proptest! {
    #[test]
    fn json_reads_back(mapped in mapped()) {
        let (_, graph) = graph_of(&mapped);
        let found: Value = serde_json::from_str(&graph.to_json(&NAMES)).unwrap();
        let bundles = graph.bundles().iter().enumerate().map(|(id, bundle)| {
            (id, bundle.height(), spans(&graph, &bundle.submotions))
        });
        for (id, height, spans) in bundles {
            let bundle = &found["bundles"][id];
            prop_assert_eq!(&bundle["id"], &json!(id));
            prop_assert_eq!(&bundle["height"], &json!(height));
            prop_assert_eq!(&bundle["spans"], &json!(spans));
            let close = |name: &str, expected: f64| {
                (bundle[name].as_f64().unwrap() - expected).abs() <= ROUNDING * expected
            };
            prop_assert!(close("mean_frames", graph.bundles()[id].mean_frames()));
            prop_assert!(close("volume", graph.bundles()[id].volume));
        }
        prop_assert_eq!(found["bundles"].as_array().unwrap().len(), graph.bundles().len());
        let edges = graph.edges().iter().map(|edge| {
            let passages = edge.passages.iter().map(|passage| {
                let transition = passage.transition.as_ref();
                let transition = transition.map(|t| spans(&graph, std::slice::from_ref(t)).remove(0));
                json!({"exit": passage.exit, "entry": passage.entry, "transition": transition})
            });
            json!({"from": edge.from, "to": edge.to, "passages": passages.collect::<Vec<_>>()})
        });
        prop_assert_eq!(&found["edges"], &json!(edges.collect::<Vec<_>>()));
        prop_assert_eq!(&found["loose"], &json!(spans(&graph, graph.loose())));
    }

    #[test]
    fn graphml_is_well_formed(mapped in mapped()) {
        let (_, graph) = graph_of(&mapped);
        let (elements, texts) = xml(&graph.to_graphml(&NAMES));
        let count = |name: &str| elements.iter().filter(|(found, _)| found == name).count();
        prop_assert_eq!(count("node"), graph.bundles().len());
        prop_assert_eq!(count("edge"), graph.edges().len());
        for bundle in graph.bundles() {
            // U+0001 is no character of XML 1.0.
            let label = labels(&graph, &bundle.submotions).replace('\u{1}', "\u{fffd}");
            prop_assert!(texts.contains(&label), "{label:?} in {texts:?}");
        }
    }

    #[test]
    fn svg_boxes_show_heights_and_widths(mapped in mapped()) {
        let (_, graph) = graph_of(&mapped);
        let (elements, texts) = xml(&graph.to_svg(&NAMES));
        let rectangles = elements.iter().filter(|(name, _)| name == "rect");
        let places: Vec<[f64; 4]> = rectangles
            .map(|(_, at)| ["x", "y", "width", "height"].map(|name| number(at, name)))
            .collect();
        prop_assert_eq!(places.len(), graph.bundles().len());
        let ratio = |a: f64, b: f64| (a / b - 1.0).abs() < ROUNDING;
        for (bundle, place) in graph.bundles().iter().zip(&places) {
            let first = &graph.bundles()[0];
            let frames = bundle.mean_frames() / first.mean_frames();
            let heights = (bundle.height() as f64 / first.height() as f64).sqrt();
            prop_assert!(ratio(place[2] / places[0][2], frames));
            prop_assert!(ratio(place[3] / places[0][3], heights));
            let label = labels(&graph, &bundle.submotions).replace('\u{1}', "\u{fffd}");
            prop_assert!(texts.contains(&label));
        }
        let (_, canvas) = &elements[0];
        for (index, a) in places.iter().enumerate() {
            prop_assert!(a[0] >= 0.0 && a[0] + a[2] <= number(canvas, "width"));
            prop_assert!(a[1] >= 0.0 && a[1] + a[3] <= number(canvas, "height"));
            for b in &places[..index] {
                let is_beside = a[0] + a[2] < b[0] || b[0] + b[2] < a[0];
                prop_assert!(is_beside || a[1] + a[3] < b[1] || b[1] + b[3] < a[1]);
            }
        }
        let arrows = elements.iter().filter(|(_, at)| at.iter().any(|(key, _)| key == "marker-end"));
        prop_assert_eq!(arrows.count(), graph.edges().len());
    }

    #[test]
    fn dot_quotes_close(mapped in mapped()) {
        let (_, graph) = graph_of(&mapped);
        let dot = graph.to_dot(&NAMES);
        let mut strings = Vec::new();
        let mut characters = dot.chars();
        while characters.by_ref().any(|c| c == '"') {
            let mut string = String::new();
            loop {
                match characters.next().unwrap() {
                    '"' => break,
                    '\\' => string.extend(characters.next()),
                    '\n' => panic!("a line ends inside quotes"),
                    other => string.push(other),
                }
            }
            strings.push(string);
        }
        // A label and a tooltip for each bundle, a label for each edge.
        prop_assert_eq!(strings.len(), 2 * graph.bundles().len() + graph.edges().len());
        for (id, bundle) in graph.bundles().iter().enumerate() {
            let control = labels(&graph, &bundle.submotions).replace('\n', "u000a");
            let control = control.replace('\t', "u0009").replace('\u{1}', "u0001");
            prop_assert_eq!(&strings[2 * id + 1], &control);
        }
        let arrows = dot.lines().filter(|line| line.contains(" -> ")).count();
        prop_assert_eq!(arrows, graph.edges().len());
    }
}
