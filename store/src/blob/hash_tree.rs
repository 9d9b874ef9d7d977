//! The hashes that lie between a blob's name and its parts, so that a part can be verified without the whole.
//!
//! BLAKE3 is a tree: the hash of a content is made of chaining values of its subtrees. Those of [`GROUP`] bytes each are kept;
//! they belong to the content if they merge to its hash, and a part belongs to it if its groups have their chaining values.
//! (J. O'Connor, J.-P. Aumasson, S. Neves, Z. Wilcox-O'Hearn, BLAKE3, section 6.4 "Verified streaming".)

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use blake3::hazmat::{ChainingValue, HasherExt, Mode, merge_subtrees_non_root, merge_subtrees_root};

use crate::blob_id::BlobId;

/// Bytes of a subtree whose chaining value is kept: a power of two of BLAKE3's chunks. A range costs up to two groups more
/// than it has, and the values of a blob of 1 GiB take 128 KiB.
pub(crate) const GROUP: u64 = 256 << 10;

/// Trees that are kept.
const TREES: usize = 64;

/// The chaining values of a content of more than one group.
#[derive(Debug)]
pub(crate) struct HashTree {
    groups: Vec<ChainingValue>,
    /// Bytes of the content.
    length: u64,
}

impl HashTree {
    /// True if bytes that begin at a group's beginning and end at a group's or the content's end are this content's.
    pub(crate) fn holds(&self, start: u64, bytes: &[u8]) -> bool {
        let first = usize::try_from(start / GROUP).unwrap_or(usize::MAX);
        let mut expected = self.groups.iter().skip(first);
        let mut hashed = HashTreeBuilder::starting_at(start);
        hashed.update(bytes);
        hashed.finish_group();
        hashed.groups.iter().all(|value| expected.next() == Some(value))
    }

    /// The range with its groups made whole, cut off at the content's end; none if it begins beyond that.
    pub(crate) fn whole_groups(&self, bytes: &Range<u64>) -> Option<Range<u64>> {
        if bytes.is_empty() || bytes.start >= self.length {
            return None;
        }
        let start = bytes.start / GROUP * GROUP;
        Some(start..bytes.end.min(self.length).next_multiple_of(GROUP).min(self.length))
    }
}

/// Makes a tree from a content that comes in pieces.
pub(crate) struct HashTreeBuilder {
    groups: Vec<ChainingValue>,
    group: blake3::Hasher,
    /// Beginning of the current group \[bytes\].
    start: u64,
}

impl HashTreeBuilder {
    pub(crate) fn new() -> Self {
        Self::starting_at(0)
    }

    fn starting_at(start: u64) -> Self {
        Self { groups: Vec::new(), group: blake3::Hasher::new(), start }
    }

    pub(crate) fn update(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            if self.group.count() == GROUP {
                self.finish_group();
            }
            if self.group.count() == 0 {
                self.group.set_input_offset(self.start);
            }
            let room = usize::try_from(GROUP - self.group.count()).unwrap_or(usize::MAX);
            let (now, later) = bytes.split_at(room.min(bytes.len()));
            self.group.update(now);
            bytes = later;
        }
    }

    fn finish_group(&mut self) {
        if self.group.count() == 0 {
            return;
        }
        self.groups.push(self.group.finalize_non_root());
        self.start += self.group.count();
        self.group = blake3::Hasher::new();
    }

    /// The tree; none if the content does not have this name, or fits in one group.
    pub(crate) fn finish(mut self, name: BlobId) -> Option<HashTree> {
        self.finish_group();
        let (left, right) = halves(&self.groups)?;
        let root = merge_subtrees_root(&merge(left)?, &merge(right)?, Mode::Hash);
        (BlobId::from(root) == name).then_some(HashTree { groups: self.groups, length: self.start })
    }
}

/// The chaining value of neighbouring groups; none of none.
fn merge(groups: &[ChainingValue]) -> Option<ChainingValue> {
    match groups {
        [] => None,
        [only] => Some(*only),
        groups => {
            let (left, right) = halves(groups)?;
            Some(merge_subtrees_non_root(&merge(left)?, &merge(right)?, Mode::Hash))
        }
    }
}

/// The left subtree has the greatest power of two of groups that leaves something for the right one (section 2.1).
fn halves(groups: &[ChainingValue]) -> Option<(&[ChainingValue], &[ChainingValue])> {
    (groups.len() > 1).then(|| groups.split_at(groups.len().next_power_of_two() / 2))
}

/// The trees that were requested last.
#[derive(Debug, Default)]
pub(crate) struct HashTrees(Mutex<VecDeque<(BlobId, Arc<HashTree>)>>);

impl HashTrees {
    pub(crate) fn get(&self, id: BlobId) -> Option<Arc<HashTree>> {
        let mut trees = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let place = trees.iter().position(|(known, _)| *known == id)?;
        let found = trees.remove(place)?;
        let tree = found.1.clone();
        trees.push_back(found);
        Some(tree)
    }

    pub(crate) fn keep(&self, id: BlobId, tree: Arc<HashTree>) {
        let mut trees = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        trees.retain(|(known, _)| *known != id);
        if trees.len() == TREES {
            trees.pop_front();
        }
        trees.push_back((id, tree));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(length: usize) -> Vec<u8> {
        (0..length).map(|index| (index % 251) as u8).collect()
    }

    fn tree(content: &[u8], piece: usize) -> Option<HashTree> {
        let mut builder = HashTreeBuilder::new();
        content.chunks(piece).for_each(|piece| builder.update(piece));
        builder.finish(BlobId::of(content))
    }

    #[test]
    fn the_groups_merge_to_the_hash_of_the_whole() {
        const GROUP: usize = super::GROUP as usize;
        for length in [GROUP + 1, 2 * GROUP, 2 * GROUP + 1, 3 * GROUP - 1, 5 * GROUP + 777, 8 * GROUP] {
            for piece in [1_000, GROUP, length] {
                let tree = tree(&content(length), piece).expect("the name is the content's");
                assert_eq!((tree.length, tree.groups.len()), (length as u64, length.div_ceil(GROUP)));
            }
        }
        assert!(tree(&content(GROUP), 1_000).is_none());
        let mut other = HashTreeBuilder::new();
        other.update(&content(2 * GROUP));
        assert!(other.finish(BlobId::of(b"another content")).is_none());
    }

    #[test]
    fn a_part_differs_from_a_changed_one_and_from_another_part() {
        const GROUP: usize = super::GROUP as usize;
        let content = content(3 * GROUP + 5);
        let tree = tree(&content, content.len()).expect("the name is the content's");
        let range =
            tree.whole_groups(&(GROUP as u64 + 7..2 * GROUP as u64 + 1)).expect("it is in the content");
        assert_eq!(range, GROUP as u64..3 * GROUP as u64);
        let mut part = content[GROUP..3 * GROUP].to_vec();
        assert!(tree.holds(range.start, &part));
        assert!(!tree.holds(0, &part));
        part[GROUP + 3] ^= 1;
        assert!(!tree.holds(range.start, &part));
        let end = tree.whole_groups(&(3 * GROUP as u64 + 1..u64::MAX)).expect("it begins in the content");
        assert_eq!(end, 3 * GROUP as u64..content.len() as u64);
        assert!(tree.holds(end.start, &content[3 * GROUP..]));
        assert!(!tree.holds(end.start, &content[3 * GROUP..content.len() - 1]));
        assert_eq!(tree.whole_groups(&(content.len() as u64..u64::MAX)), None);
    }
}
