//! Every byte and every invariant of a shard.

use super::ShardError;
use super::layout::Part;
use super::packed::BLOCK;
use super::view::{Dictionary, View};
use crate::DocId;
use crate::document::Document;

pub(super) fn verify(view: View<'_>) -> Result<(), ShardError> {
    let mut pages = view.source().pages.starts();
    if pages.all(|start| view.check_page(start)) {
        check_documents(&view);
    }
    if let Some(dictionary) = view.dictionary() {
        check_segments(&view);
        check_lists(&view, dictionary);
    }
    view.finish(())
}

/// The clip table is in order, and its ends are those of the other sections.
fn check_documents(view: &View<'_>) {
    let counts = view.counts();
    let n_documents = counts.n_documents as usize;
    let flaw = |entry, expected, found| view.flaw(Part::Documents, entry, expected, found);
    let first = view.row(0);
    if first.first_frame != 0 || first.first_segment != 0 {
        flaw(
            0,
            "a first document at frame 0 and segment 0",
            first.first_frame,
        );
    }
    if first.name != counts.prefix_len as usize {
        flaw(
            0,
            "a first name behind the shared beginning",
            first.name as u64,
        );
    }
    for number in 0..counts.n_documents {
        match Document::read(view.source(), DocId::from_number(number)) {
            Err(error) => return view.fail(error),
            Ok(document) if (document.n_segments() == 0) != (document.n_frames() == 0) => {
                let expected = "no frames without segments";
                return flaw(number as usize, expected, document.n_frames() as u64);
            }
            Ok(_) => {}
        }
    }
    let end = view.row(n_documents);
    if end.first_segment != view.n_segments() || end.first_frame != counts.n_frames {
        flaw(
            n_documents,
            "an end after the last segment and frame",
            end.first_frame,
        );
    }
    let text_len = view.source().layout.len_of(Part::Text);
    if end.name != text_len || end.meta != text_len {
        flaw(n_documents, "an end of the text", end.meta as u64);
    }
}

/// The segments of every document tile it and are maximal.
fn check_segments(view: &View<'_>) {
    let (n_documents, n_segments) = (view.counts().n_documents as usize, view.n_segments());
    let mut document = 0;
    let mut next_first = 0;
    let mut frames = view.frames();
    let mut end = 0;
    let mut before = None;
    for k in 0..n_segments {
        let entry = view.entry(k);
        // Empty documents begin where the next one does.
        while document < n_documents && next_first == k {
            let row = view.row(document);
            if row.first_frame != end {
                view.flaw(
                    Part::Documents,
                    document,
                    "the frame of its first segment",
                    row.first_frame,
                );
            }
            document += 1;
            next_first = view.row(document).first_segment;
            before = None;
        }
        if entry.is_first != before.is_none() {
            let expected = "a mark on the first segment of each document alone";
            view.flaw(Part::Segments, k, expected, u64::from(entry.is_first));
        }
        if before == Some(entry.word) {
            let expected = "a word other than that of the segment before";
            view.flaw(Part::Segments, k, expected, entry.word as u64);
        }
        before = Some(entry.word);
        // The start of a block is stated; elsewhere it follows from the lengths.
        let start = frames.start_of(k);
        if start != end {
            view.flaw(
                Part::Frames,
                k / BLOCK,
                "the end of the segment before",
                start,
            );
        }
        end = frames.end_of(k);
        if end <= start {
            view.flaw(Part::Lengths, k, "a length of at least one frame", end);
        }
        if view.failed() {
            return;
        }
    }
    if end != view.counts().n_frames {
        view.flaw(Part::Frames, n_segments, "the number of all frames", end);
    }
}

/// Every segment stands in the list of its word, once: the lists are increasing and of the right word, and there are
/// as many postings as segments, so none can be missing.
fn check_lists(view: &View<'_>, dictionary: &Dictionary) {
    for list in 0..dictionary.words.len() {
        for segment in view.postings(dictionary, list) {
            if view.entry(segment).word != list {
                let expected = "a segment that carries the word of its list";
                view.flaw(Part::Lists, list, expected, segment as u64);
            }
        }
        if view.failed() {
            return;
        }
    }
}
