//! Inverted lists, raw and packed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use bitpacking::{BitPacker, BitPacker4x};

use crate::segments::{Position, Segments};

/// The sorted segments of each word, all in one vector.
pub(crate) struct RawLists {
    starts: Vec<u32>,
    postings: Vec<u32>,
}

impl RawLists {
    pub(crate) fn of(segments: &Segments) -> Self {
        let mut starts = vec![0; segments.distinct.len() + 1];
        for &number in &segments.numbers {
            starts[number as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut ends = starts.clone();
        let mut postings = vec![0; segments.len()];
        for (segment, &number) in segments.numbers.iter().enumerate() {
            let end = &mut ends[number as usize];
            postings[*end as usize] = segment as u32;
            *end += 1;
        }
        Self { starts, postings }
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.postings[..]) + size_of_val(&self.starts[..])
    }

    pub(crate) fn list(&self, number: usize) -> &[u32] {
        &self.postings[self.starts[number] as usize..self.starts[number + 1] as usize]
    }

    /// List by list.
    pub(crate) fn union(
        &self,
        segments: &Segments,
        position: Position,
        mut visit: impl FnMut(usize),
    ) {
        for number in segments.accepted(position) {
            self.list(number).iter().for_each(|&at| visit(at as usize));
        }
    }

    /// In the order of segments.
    pub(crate) fn merge(
        &self,
        segments: &Segments,
        position: Position,
        mut visit: impl FnMut(usize),
    ) {
        let accepted = segments.accepted(position);
        let lists = accepted.iter().map(|&number| self.list(number));
        let mut lists: Vec<&[u32]> = lists.collect();
        let heads = lists.iter().enumerate();
        let heads = heads.filter_map(|(i, list)| Some(Reverse((*list.first()?, i))));
        let mut heap: BinaryHeap<_> = heads.collect();
        while let Some(mut head) = heap.peek_mut() {
            let Reverse((segment, i)) = *head;
            visit(segment as usize);
            lists[i] = &lists[i][1..];
            match lists[i].first() {
                Some(&next) => *head = Reverse((next, i)),
                None => {
                    std::collections::binary_heap::PeekMut::pop(head);
                }
            }
        }
    }
}

/// The same lists as gaps less one, each list's first segment whole, in blocks of 128 of one width.
pub(crate) struct PackedLists {
    starts: Vec<u32>,
    /// Per block its width and where it begins.
    blocks: Vec<(u8, u32)>,
    bytes: Vec<u8>,
}

const BLOCK: usize = BitPacker4x::BLOCK_LEN;

impl PackedLists {
    pub(crate) fn of(lists: &RawLists) -> Self {
        let packer = BitPacker4x::new();
        let mut gaps = Vec::with_capacity(lists.postings.len());
        for number in 0..lists.starts.len() - 1 {
            let list = lists.list(number);
            gaps.extend(list.first());
            gaps.extend(list.windows(2).map(|pair| pair[1] - pair[0] - 1));
        }
        let (mut blocks, mut bytes) = (Vec::new(), Vec::new());
        for block in gaps.chunks(BLOCK) {
            let mut whole = [0; BLOCK];
            whole[..block.len()].copy_from_slice(block);
            let width = packer.num_bits(&whole);
            let start = bytes.len();
            blocks.push((width, start as u32));
            bytes.resize(start + BitPacker4x::compressed_block_size(width), 0);
            packer.compress(&whole, &mut bytes[start..], width);
        }
        Self {
            starts: lists.starts.clone(),
            blocks,
            bytes,
        }
    }

    /// With a byte for the width and four for the place of each block, and the lengths of lists at
    /// their starts.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes.len() + 5 * self.blocks.len() + size_of_val(&self.starts[..])
    }

    pub(crate) fn union(
        &self,
        segments: &Segments,
        position: Position,
        mut visit: impl FnMut(usize),
    ) {
        let mut reader = PackedReader::of(self);
        for number in segments.accepted(position) {
            reader.list(number, &mut visit);
        }
    }

    pub(crate) fn list(&self, number: usize) -> Vec<u32> {
        let mut list = Vec::new();
        PackedReader::of(self).list(number, &mut |segment| list.push(segment as u32));
        list
    }
}

/// Keeps the block it unpacked last.
struct PackedReader<'a> {
    lists: &'a PackedLists,
    packer: BitPacker4x,
    block: Option<usize>,
    gaps: [u32; BLOCK],
}

impl<'a> PackedReader<'a> {
    fn of(lists: &'a PackedLists) -> Self {
        Self {
            lists,
            packer: BitPacker4x::new(),
            block: None,
            gaps: [0; BLOCK],
        }
    }

    fn list(&mut self, number: usize, visit: &mut impl FnMut(usize)) {
        let starts = &self.lists.starts;
        let (mut at, end) = (starts[number] as usize, starts[number + 1] as usize);
        let mut next = 0;
        while at < end {
            let block = at / BLOCK;
            if self.block != Some(block) {
                let (width, start) = self.lists.blocks[block];
                let bytes = &self.lists.bytes[start as usize..];
                self.packer.decompress(bytes, &mut self.gaps, width);
                self.block = Some(block);
            }
            let until = end.min((block + 1) * BLOCK);
            for &gap in &self.gaps[at % BLOCK..][..until - at] {
                next += gap as usize;
                visit(next);
                next += 1;
            }
            at = until;
        }
    }
}
