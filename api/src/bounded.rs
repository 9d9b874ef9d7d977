//! Readers of lists and maps that stop at their largest size, before further entries take memory.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::hash::Hash;
use std::marker::PhantomData;

use indexmap::IndexMap;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use crate::service::LIMITS;

/// The changes of a request, [`LIMITS`]`.changes_per_request` at most.
pub(crate) fn changes<'de, D: Deserializer<'de>>(format: D) -> Result<BTreeMap<String, Value>, D::Error> {
    map(format, LIMITS.changes_per_request, "changes")
}

/// The axes of a request, [`LIMITS`]`.axes_per_sweep` at most.
pub(crate) fn axes<'de, D, Name, Values>(format: D) -> Result<IndexMap<Name, Values>, D::Error>
where
    D: Deserializer<'de>,
    Name: Deserialize<'de> + Hash + Eq,
    Values: Deserialize<'de>,
{
    map(format, LIMITS.axes_per_sweep, "axes")
}

/// The tags of a sweep, [`LIMITS`]`.tags_per_sweep` at most.
pub(crate) fn tags<'de, D: Deserializer<'de>>(format: D) -> Result<BTreeSet<String>, D::Error> {
    list(format, LIMITS.tags_per_sweep, "tags")
}

/// New tags of a sweep, if they are given.
pub(crate) fn new_tags<'de, D: Deserializer<'de>>(format: D) -> Result<Option<BTreeSet<String>>, D::Error> {
    Ok(Option::<Tags>::deserialize(format)?.map(|Tags(tags)| tags))
}

/// The values of an axis, if they are given: [`LIMITS`]`.points_per_sweep` at most.
pub(crate) fn values<'de, D: Deserializer<'de>>(format: D) -> Result<Option<Vec<f64>>, D::Error> {
    list::<_, f64, _>(format, LIMITS.points_per_sweep, "values").map(Some)
}

/// Parameters of a refinement, two at most.
pub(crate) fn pair<'de, D: Deserializer<'de>, Name: Deserialize<'de>>(
    format: D,
) -> Result<Vec<Name>, D::Error> {
    list(format, 2, "parameters")
}

#[derive(serde::Deserialize)]
struct Tags(#[serde(deserialize_with = "tags")] BTreeSet<String>);

fn map<'de, D, K, V, M>(format: D, most: usize, entries: &'static str) -> Result<M, D::Error>
where
    D: Deserializer<'de>,
    K: Deserialize<'de>,
    V: Deserialize<'de>,
    M: Default + Extend<(K, V)>,
{
    format.deserialize_map(Map(Bound { most, entries }, PhantomData))
}

fn list<'de, D, T, L>(format: D, most: usize, entries: &'static str) -> Result<L, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
    L: Default + Extend<T>,
{
    format.deserialize_seq(List(Bound { most, entries }, PhantomData))
}

/// The largest number of entries, and their name.
pub(crate) struct Bound {
    pub(crate) most: usize,
    pub(crate) entries: &'static str,
}

impl Bound {
    /// Refuses a further entry after `number` of them, if these are the most.
    pub(crate) fn check<E: Error>(&self, number: usize) -> Result<(), E> {
        if number < self.most {
            return Ok(());
        }
        Err(E::custom(format_args!("there may be at most {} {}", self.most, self.entries)))
    }
}

struct Map<M, K, V>(Bound, PhantomData<(M, K, V)>);

impl<'de, K, V, M> Visitor<'de> for Map<M, K, V>
where
    K: Deserialize<'de>,
    V: Deserialize<'de>,
    M: Default + Extend<(K, V)>,
{
    type Value = M;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a map")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<M, A::Error> {
        let mut map = M::default();
        let mut number = 0;
        while let Some(key) = members.next_key()? {
            self.0.check(number)?;
            map.extend([(key, members.next_value()?)]);
            number += 1;
        }
        Ok(map)
    }
}

struct List<L, T>(Bound, PhantomData<(L, T)>);

impl<'de, T: Deserialize<'de>, L: Default + Extend<T>> Visitor<'de> for List<L, T> {
    type Value = L;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a sequence")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<L, A::Error> {
        let mut list = L::default();
        let mut number = 0;
        while let Some(entry) = entries.next_element()? {
            self.0.check(number)?;
            list.extend([entry]);
            number += 1;
        }
        Ok(list)
    }
}
