//! Segments and their words, as they are and packed.

pub(crate) const WORD_BITS: usize = u64::BITS as usize;

/// Segments of all documents in order, with what every form is made from.
pub(crate) struct Segments {
    /// The word of each segment.
    pub(crate) words: Vec<u64>,
    /// Whether it is the first of its document.
    pub(crate) is_first: Vec<bool>,
    /// The distinct words, increasing.
    pub(crate) distinct: Vec<u64>,
    /// Per segment the number of its word.
    pub(crate) numbers: Vec<u32>,
}

/// What one position of a query accepts: words that agree with `value` on the bits of `care`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub(crate) care: u64,
    pub(crate) value: u64,
}

impl Position {
    pub(crate) fn holds(self, word: u64) -> bool {
        (word ^ self.value) & self.care == 0
    }
}

impl Segments {
    pub(crate) fn of(documents: &[Vec<u64>]) -> Self {
        let mut segments = Self {
            words: Vec::new(),
            is_first: Vec::new(),
            distinct: Vec::new(),
            numbers: Vec::new(),
        };
        for document in documents {
            let runs = document.chunk_by(|a, b| a == b);
            segments.words.extend(runs.map(|run| run[0]));
            let mut is_first = true;
            segments
                .is_first
                .resize_with(segments.words.len(), || std::mem::take(&mut is_first));
        }
        segments.distinct.clone_from(&segments.words);
        segments.distinct.sort_unstable();
        segments.distinct.dedup();
        let number = |word: &u64| segments.distinct.partition_point(|other| other < word) as u32;
        segments.numbers = segments.words.iter().map(number).collect();
        segments
    }

    pub(crate) fn len(&self) -> usize {
        self.words.len()
    }

    /// The number of a word that is there.
    pub(crate) fn number(&self, word: u64) -> usize {
        self.distinct.binary_search(&word).expect("a known word")
    }

    /// One pass over the words themselves.
    pub(crate) fn scan(&self, position: Position, mut visit: impl FnMut(usize)) {
        for (segment, &word) in self.words.iter().enumerate() {
            if position.holds(word) {
                visit(segment);
            }
        }
    }

    /// A bit for each distinct word that a position accepts.
    pub(crate) fn members(&self, position: Position) -> Vec<u64> {
        let bits = |words: &[u64]| {
            let words = words.iter().enumerate();
            words.fold(0, |bits, (i, &word)| {
                bits | u64::from(position.holds(word)) << i
            })
        };
        self.distinct.chunks(WORD_BITS).map(bits).collect()
    }

    /// The numbers of the distinct words that a position accepts.
    pub(crate) fn accepted(&self, position: Position) -> Vec<usize> {
        if position.care == u64::MAX {
            return Vec::from_iter(self.distinct.binary_search(&position.value).ok());
        }
        let mut numbers = Vec::new();
        for (at, bits) in self.members(position).into_iter().enumerate() {
            each_bit(bits, |i| numbers.push(WORD_BITS * at + i));
        }
        numbers
    }
}

pub(crate) fn each_bit(mut bits: u64, mut visit: impl FnMut(usize)) {
    while bits != 0 {
        visit(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// Numbers of words at one width with a bit for the first of a document, as a shard has them.
pub(crate) struct PackedNumbers {
    width: usize,
    bytes: Vec<u8>,
}

impl PackedNumbers {
    pub(crate) fn of(segments: &Segments) -> Self {
        let width = 1 + segments.distinct.len().ilog2() as usize + 1;
        let mut bytes = vec![0; (segments.len() * width).div_ceil(8) + 8];
        for (segment, &number) in segments.numbers.iter().enumerate() {
            let entry = u64::from(number) << 1 | u64::from(segments.is_first[segment]);
            let at = segment * width;
            let place = &mut bytes[at / 8..at / 8 + 8];
            let old = place
                .iter()
                .rev()
                .fold(0, |all, &b| all << 8 | u64::from(b));
            place.copy_from_slice(&(old | entry << (at % 8)).to_le_bytes());
        }
        Self { width, bytes }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.bytes.len()
    }

    /// The number of the word, and whether the segment is the first of its document.
    #[inline]
    pub(crate) fn entry(&self, segment: usize) -> (usize, bool) {
        let at = segment * self.width;
        let bytes = self.bytes[at / 8..]
            .first_chunk()
            .expect("bytes behind all");
        let entry = u64::from_le_bytes(*bytes) >> (at % 8) & ((1 << self.width) - 1);
        ((entry >> 1) as usize, entry & 1 == 1)
    }

    pub(crate) fn scan(
        &self,
        segments: &Segments,
        position: Position,
        mut visit: impl FnMut(usize),
    ) {
        let members = segments.members(position);
        for segment in 0..segments.len() {
            if is_set(&members, self.entry(segment).0) {
                visit(segment);
            }
        }
    }
}

#[inline]
pub(crate) fn is_set(bits: &[u64], at: usize) -> bool {
    bits[at / WORD_BITS] >> (at % WORD_BITS) & 1 == 1
}
