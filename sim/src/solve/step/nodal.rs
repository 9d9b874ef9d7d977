//! Nodal fields in checkpoints: one row of numbers, node by node, since serde knows no arrays of a length that is a parameter.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::math::linalg::NodalField;

pub(crate) fn serialize<S: Serializer, const D: usize>(
    values: &NodalField<D>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    values.to_nodes().as_flattened().serialize(serializer)
}

pub(crate) fn deserialize<'de, T: Deserializer<'de>, const D: usize>(
    deserializer: T,
) -> Result<NodalField<D>, T::Error> {
    let flat = Vec::<f64>::deserialize(deserializer)?;
    match flat.as_chunks::<D>() {
        (nodes, []) => Ok(NodalField::from_nodes(nodes)),
        _ => Err(de::Error::invalid_length(flat.len(), &"a multiple of a node's degrees of freedom")),
    }
}
