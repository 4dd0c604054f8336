//! Strongly connected components of a small graph.

/// The components of a graph with `count` nodes, each in ascending order.
pub fn components(count: usize, edges: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let reached: Vec<Vec<bool>> = (0..count).map(|node| reachable(node, count, edges)).collect();
    let mut found: Vec<Vec<usize>> = Vec::new();
    for node in 0..count {
        let own = found.iter_mut().find(|component| reached[component[0]][node] && reached[node][component[0]]);
        match own {
            Some(component) => component.push(node),
            None => found.push(vec![node]),
        }
    }
    found
}

/// Which nodes can be reached from a node, including itself.
fn reachable(start: usize, count: usize, edges: &[[usize; 2]]) -> Vec<bool> {
    let mut reached = vec![false; count];
    let mut open = vec![start];
    while let Some(node) = open.pop() {
        if !std::mem::replace(&mut reached[node], true) {
            open.extend(edges.iter().filter(|edge| edge[0] == node).map(|edge| edge[1]));
        }
    }
    reached
}
