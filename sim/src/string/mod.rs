//! The string's mesh: elements, nodes, gauges, masses.
