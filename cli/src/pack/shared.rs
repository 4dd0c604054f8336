//! Items that are stored once, however often they are added.

use serde::Serialize;
use std::collections::{BTreeMap, btree_map::Entry};

/// The items of one kind, in the order in which they were first added.
pub struct Shared<T> {
    items: Vec<T>,
    places: BTreeMap<String, u32>,
}

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self { items: Vec::new(), places: BTreeMap::new() }
    }
}

impl<T> Shared<T> {
    /// The index of the item with a key. It is made if there is none yet.
    pub fn place(&mut self, key: String, make: impl FnOnce() -> T) -> u32 {
        match self.places.entry(key) {
            Entry::Occupied(place) => *place.get(),
            Entry::Vacant(vacant) => {
                self.items.push(make());
                *vacant.insert(self.items.len() as u32 - 1)
            }
        }
    }

    pub fn into_items(self) -> Vec<T> {
        self.items
    }
}

impl<T: Serialize> Shared<T> {
    /// The index of an item. Items with the same JSON are the same.
    pub fn add(&mut self, item: T) -> u32 {
        let key = serde_json::to_string(&item).expect("items have names as keys and finite numbers");
        self.place(key, || item)
    }
}
