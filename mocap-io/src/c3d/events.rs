use super::ByteOrder;
use super::error::C3dWarningKind;
use super::header::{BLOCK, f32_at, u16_at};
use super::parameters::{Parameters, trimmed_text};

/// Something that happened at a time, such as a foot strike.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// What happened.
    pub label: String,
    /// Whom or which side it concerns, such as `Left`, if the file says so.
    pub context: Option<String>,
    /// The subject's name, if the file says so.
    pub subject: Option<String>,
    /// Seconds from the first frame of the file; may lie outside the recording.
    pub seconds: f64,
    /// Where the file says it. Many files list the same events twice.
    pub source: EventSource,
}

/// Where a C3D file lists an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EventSource {
    /// In the header: at most 18, with labels of four characters.
    Header,
    /// In the EVENT group of the parameters.
    Parameters,
}

/// Marks a header whose events have labels.
const KEY: u16 = 12_345;
const MAX_HEADER_EVENTS: usize = 18;
/// Where words of the header are, in bytes.
const KEY_AT: usize = 298;
const COUNT_AT: usize = 300;
const TIMES_AT: usize = 304;
const LABELS_AT: usize = 396;

/// Times in the header count from the first frame of the file (c3d.org, "Header events").
pub(super) fn in_header(
    block: &[u8; BLOCK],
    order: ByteOrder,
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> Vec<Event> {
    if u16_at(block, KEY_AT, order) != KEY {
        return Vec::new();
    }
    let count = usize::from(u16_at(block, COUNT_AT, order)).min(MAX_HEADER_EVENTS);
    let mut events = Vec::with_capacity(count);
    for i in 0..count {
        let at = TIMES_AT + 4 * i;
        let seconds = f64::from(f32_at(block, at, order));
        if !seconds.is_finite() {
            oddities.push((at, C3dWarningKind::Events { count: 1 }));
            continue;
        }
        events.push(Event {
            label: trimmed_text(&block[LABELS_AT + 4 * i..][..4]),
            context: None,
            subject: None,
            seconds,
            source: EventSource::Header,
        });
    }
    events
}

/// Times in the EVENT group are minutes and seconds and count from frame 1, which a file that was cut
/// out of a longer recording does not have (c3d.org, "EVENT:TIMES"); `first_seconds` is its first frame.
pub(super) fn in_parameters(
    parameters: &Parameters,
    first_seconds: f64,
    oddities: &mut Vec<(usize, C3dWarningKind)>,
) -> Vec<Event> {
    let labels = parameters.texts("EVENT", "LABELS");
    let contexts = parameters.texts("EVENT", "CONTEXTS");
    let subjects = parameters.texts("EVENT", "SUBJECTS");
    let times = parameters.numbers("EVENT", "TIMES", false);
    let used = parameters.number("EVENT", "USED").unwrap_or(0.0);
    let said = |texts: &[String], i: usize| texts.get(i).filter(|t| !t.is_empty()).cloned();
    let mut events = Vec::new();
    let mut n_timeless = 0;
    // A wrong count must not make events out of nothing.
    let listed = labels.len().max(times.len() / 2);
    for i in 0..listed.min(used.max(0.0) as usize) {
        let time = times.get(2 * i..2 * i + 2).map(|t| t[0] * 60.0 + t[1]);
        let Some(seconds) = time.filter(|t| t.is_finite()) else {
            n_timeless += 1;
            continue;
        };
        events.push(Event {
            label: labels.get(i).cloned().unwrap_or_default(),
            context: said(&contexts, i),
            subject: said(&subjects, i),
            seconds: seconds - first_seconds,
            source: EventSource::Parameters,
        });
    }
    if n_timeless > 0 {
        let byte = parameters.get("EVENT", "USED").map_or(0, |p| p.byte);
        oddities.push((byte, C3dWarningKind::Events { count: n_timeless }));
    }
    events
}
