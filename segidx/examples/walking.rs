//! The walking motion of the 2005 paper: its segments, inverted lists, and exact and adaptive hits.

use segidx::{FuzzySet, Hit, IndexBuilder, Query, search_adaptive, search_exact};

/// Bit 1: right foot in front. Bit 0: left foot in front.
const WALK: [u64; 20] = [
    0b11, 0b11, 0b01, 0b01, 0b01, 0b11, 0b10, 0b10, 0b11, 0b01, //
    0b01, 0b11, 0b11, 0b10, 0b10, 0b10, 0b11, 0b01, 0b01, 0b01,
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut builder = IndexBuilder::new();
    builder.push("walk", [], &WALK)?;
    let index = builder.build();

    println!("inverted lists, segments from 1:");
    for list in index.lists()? {
        let segments: Vec<u32> = list.segments.iter().map(|k| k + 1).collect();
        println!("  L({:02b}) = {segments:?}", list.word);
    }

    let exact = Query::exact(&[0b10, 0b11, 0b01], u64::MAX);
    print_hits("exact hits of 10 11 01", &search_exact(&index, &exact)?);

    // The right foot behind, in front, behind; the left one anywhere.
    let behind = FuzzySet::from_words([0b00, 0b01]);
    let in_front = FuzzySet::from_words([0b10, 0b11]);
    let fuzzy = Query::from_sets([
        (behind.clone(), Some(2)),
        (in_front, Some(5)),
        (behind, Some(2)),
    ]);
    print_hits(
        "adaptive hits of 0* 1* 0*",
        &search_adaptive(&index, &fuzzy)?,
    );
    Ok(())
}

fn print_hits(title: &str, hits: &[Hit]) {
    println!("{title}:");
    for hit in hits {
        let (number, cost) = (hit.first_segment + 1, hit.cost);
        println!("  segment {number}, frames {:?}, cost {cost}", hit.segments);
    }
}
