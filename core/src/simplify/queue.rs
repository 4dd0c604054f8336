//! The edges in the order of their cost.

use alloc::{vec, vec::Vec};

/// Stands for an edge that is not in the queue.
const ABSENT: u32 = u32::MAX;

/// A binary heap of edges, cheapest first; of equal cost, the one with the smaller number first. Costs of edges in the heap
/// can change.
pub(super) struct Queue {
    /// Cost in the high and edge in the low 32 bits. The bits of numbers that are not negative sort like the numbers.
    heap: Vec<u64>,
    /// Where each edge is in the heap.
    places: Vec<u32>,
}

impl Queue {
    /// An empty queue for edges with numbers below `edges`.
    pub(super) fn new(edges: usize) -> Self {
        Self { heap: Vec::new(), places: vec![ABSENT; edges] }
    }

    /// Adds many edges to an empty queue.
    pub(super) fn fill(&mut self, edges: impl Iterator<Item = (u32, f32)>) {
        self.heap.extend(edges.map(|(edge, cost)| key(edge, cost)));
        // A sorted list is a heap.
        self.heap.sort_unstable();
        for (place, &key) in self.heap.iter().enumerate() {
            self.places[key as u32 as usize] = place as u32;
        }
    }

    /// Takes out the cheapest edge.
    pub(super) fn pop(&mut self) -> Option<u32> {
        let edge = *self.heap.first()? as u32;
        self.remove(edge);
        Some(edge)
    }

    /// Adds an edge, or changes its cost.
    pub(super) fn set(&mut self, edge: u32, cost: f32) {
        let mut place = self.places[edge as usize] as usize;
        if place == ABSENT as usize {
            place = self.heap.len();
            self.heap.push(0);
        }
        self.put(place, key(edge, cost));
    }

    /// Removes an edge if it is there.
    pub(super) fn remove(&mut self, edge: u32) {
        let place = self.places[edge as usize];
        if place == ABSENT {
            return;
        }
        self.places[edge as usize] = ABSENT;
        let Some(last) = self.heap.pop() else { return };
        if (place as usize) < self.heap.len() {
            self.put(place as usize, last);
        }
    }

    /// Puts a key at a free place, and moves it to where it belongs.
    fn put(&mut self, mut place: usize, key: u64) {
        while place > 0 {
            let parent = (place - 1) / 2;
            if self.heap[parent] <= key {
                break;
            }
            self.settle(place, self.heap[parent]);
            place = parent;
        }
        loop {
            let mut child = 2 * place + 1;
            if child + 1 < self.heap.len() && self.heap[child + 1] < self.heap[child] {
                child += 1;
            }
            if child >= self.heap.len() || self.heap[child] >= key {
                break;
            }
            self.settle(place, self.heap[child]);
            place = child;
        }
        self.settle(place, key);
    }

    fn settle(&mut self, place: usize, key: u64) {
        self.heap[place] = key;
        self.places[key as u32 as usize] = place as u32;
    }
}

fn key(edge: u32, cost: f32) -> u64 {
    u64::from(cost.to_bits()) << 32 | u64::from(edge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_come_in_the_order_of_cost_and_number() {
        let mut costs: Vec<f32> = (0..200u32).map(|i| (i * 7919 % 50) as f32 * 0.25).collect();
        let mut queue = Queue::new(costs.len());
        queue.fill((0..100).map(|i| (i, costs[i as usize])));
        (100..200).for_each(|i| queue.set(i, costs[i as usize]));
        for i in (0..200).step_by(3) {
            costs[i] = (i % 13) as f32;
            queue.set(i as u32, costs[i]);
        }
        for i in (0..200).step_by(5) {
            queue.remove(i);
            queue.remove(i);
        }
        let mut expected: Vec<u32> = (0..200).filter(|i| i % 5 > 0).collect();
        expected.sort_by(|&a, &b| costs[a as usize].total_cmp(&costs[b as usize]).then(a.cmp(&b)));
        let found: Vec<u32> = core::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(found, expected);
    }
}
