//! Mesh of the string.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::Scenario;

/// Mesh of the string: `"auto"`, finer or coarser than that by a factor, or target element lengths.
///
/// With `auto` lengths follow from the string, its wall and the accuracy: with the factor 1 a tool joint has one element, a body between tool joints
/// eight (two if it lies more than 300 m above the bit and 50 m from recorded depths), and whatever lies on the wall by itself (collars,
/// stabilizers, plain pipe) elements of two thirds of the length (4 E I / kappa)^(1/4) over which a wall of kappa = `contact.stiffness_per_length`
/// spreads a bent pipe's force. The accuracy chooses the factor: 1.4 at `draft`, 1 at `standard`, 0.4 at `reference`. Depths whose motion is
/// recorded are nodes. It is meant for the contact law `per_length`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(untagged)]
pub enum Mesh {
    /// Lengths that follow from the string, its wall and the accuracy.
    Named(MeshName),
    /// Lengths that follow from the string and its wall, all multiplied by a factor.
    Scaled(ScaledMesh),
    /// Target element lengths.
    Lengths(ElementLengths),
}

/// Meshes with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshName {
    /// Lengths that follow from the string, its wall and the accuracy.
    Auto,
}

/// The mesh `auto` with a factor of its own in place of the accuracy's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ScaledMesh {
    /// Factor on all lengths of `auto`, above 0; usual 0.25 to 1.4: 0.5 makes every element half as long. Above 1.5 elements are
    /// longer than the length over which the wall spreads a bent pipe's force; a mesh of more than 20,000 elements is refused.
    pub auto: f64,
}

/// Target element lengths \[m\], each above 0; every stretch between two boundaries (changes of section, tool joints, gauges,
/// masses) is cut into equal elements no longer than its kind's target, at most 20,000 in all. Contact acts at nodes, so that long
/// elements miss it between them. Short ones cost time, lower RK4's stability limit in proportion, and with the law `per_node` make
/// the wall stiffer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ElementLengths {
    /// Drillpipe bodies \[m\]; usual 0.5 to 3. Too long makes the pipe too stiff against buckling between its joints.
    pub drillpipe: f64,
    /// Tool joints \[m\]; usual 0.03 to 0.3. Orbits of pipe between joints on the wall change by a third from one element a joint
    /// to eight; the shortest elements of the mesh set RK4's stability limit.
    pub tool_joint: f64,
    /// Collars \[m\]; usual 0.25 to 1, at most the length over which the wall spreads a bent collar's force, about 1.
    pub collar: f64,
    /// Stabilizers \[m\]; usual 0.25 to 1. The blades touch at the gauge's node, whatever the length.
    pub stabilizer: f64,
    /// Bit \[m\]; usual its whole length, 0.2 to 0.5, as one element.
    pub bit: f64,
}

/// A mesh with the factor on `auto` written out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum WrittenOutMesh {
    /// Factor on all lengths of `auto`.
    Auto(f64),
    /// Target element lengths.
    Lengths(ElementLengths),
}

impl Scenario {
    /// The mesh with the factor on `auto` that it gives, or else the accuracy.
    pub fn written_out_mesh(&self) -> WrittenOutMesh {
        match self.mesh {
            Mesh::Named(MeshName::Auto) => WrittenOutMesh::Auto(self.accuracy.mesh_factor()),
            Mesh::Scaled(ScaledMesh { auto }) => WrittenOutMesh::Auto(auto),
            Mesh::Lengths(lengths) => WrittenOutMesh::Lengths(lengths),
        }
    }

    /// Multiplies all lengths of the mesh, which then no longer follow the accuracy.
    pub fn scale_mesh(&mut self, factor: f64) {
        self.mesh = match self.written_out_mesh() {
            WrittenOutMesh::Auto(auto) => Mesh::auto(auto * factor),
            WrittenOutMesh::Lengths(ElementLengths { drillpipe, tool_joint, collar, stabilizer, bit }) => {
                Mesh::Lengths(ElementLengths {
                    drillpipe: drillpipe * factor,
                    tool_joint: tool_joint * factor,
                    collar: collar * factor,
                    stabilizer: stabilizer * factor,
                    bit: bit * factor,
                })
            }
        };
    }
}

impl Mesh {
    /// Lengths that follow from the string, its wall and the accuracy.
    pub const AUTO: Self = Mesh::Named(MeshName::Auto);

    /// The lengths of `auto` multiplied by a factor.
    pub fn auto(factor: f64) -> Self {
        Mesh::Scaled(ScaledMesh { auto: factor })
    }

    /// True if lengths follow from the string and its wall, with any factor.
    pub fn is_auto(&self) -> bool {
        matches!(self, Mesh::Named(MeshName::Auto) | Mesh::Scaled(_))
    }

    /// The target lengths, if they are given.
    pub fn lengths_mut(&mut self) -> Option<&mut ElementLengths> {
        match self {
            Mesh::Lengths(lengths) => Some(lengths),
            Mesh::Named(_) | Mesh::Scaled(_) => None,
        }
    }
}

/// Written out, because an untagged enum would not say which field is wrong.
impl<'de> Deserialize<'de> for Mesh {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(MeshVisitor)
    }
}

struct MeshVisitor;

impl<'de> Visitor<'de> for MeshVisitor {
    type Value = Mesh;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .write_str("\"auto\", an object with a factor on that (auto), or one with target element lengths")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Mesh, E> {
        MeshName::deserialize(StrDeserializer::new(name)).map(Mesh::Named)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Mesh, A::Error> {
        let Fields { auto, drillpipe, tool_joint, collar, stabilizer, bit } =
            Fields::deserialize(MapAccessDeserializer::new(map))?;
        let lengths = [drillpipe, tool_joint, collar, stabilizer, bit];
        if let Some(auto) = auto {
            return if lengths.iter().all(Option::is_none) {
                Ok(Mesh::Scaled(ScaledMesh { auto }))
            } else {
                Err(de::Error::custom("a factor on auto or target element lengths: one of them alone"))
            };
        }
        let given = |length: Option<f64>, field| length.ok_or_else(|| de::Error::missing_field(field));
        Ok(Mesh::Lengths(ElementLengths {
            drillpipe: given(drillpipe, "drillpipe")?,
            tool_joint: given(tool_joint, "tool_joint")?,
            collar: given(collar, "collar")?,
            stabilizer: given(stabilizer, "stabilizer")?,
            bit: given(bit, "bit")?,
        }))
    }
}

/// The fields of both forms that are objects.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Fields {
    auto: Option<f64>,
    drillpipe: Option<f64>,
    tool_joint: Option<f64>,
    collar: Option<f64>,
    stabilizer: Option<f64>,
    bit: Option<f64>,
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::{Accuracy, AccuracyPreset, preset};

    fn read(value: Value) -> Result<Mesh, String> {
        serde_json::from_value(value).map_err(|error| error.to_string())
    }

    #[test]
    fn all_forms_are_read_and_written() {
        let lengths =
            json!({"drillpipe": 1.5, "tool_joint": 0.3, "collar": 0.5, "stabilizer": 0.5, "bit": 0.25});
        for form in [json!("auto"), json!({"auto": 0.5}), lengths] {
            assert_eq!(serde_json::to_value(read(form.clone()).unwrap()).unwrap(), form);
        }
        assert!(read(json!("fine")).unwrap_err().contains("auto"));
        assert!(read(json!({"drillpipe": 1.5, "tool_joint": 0.3})).unwrap_err().contains("collar"));
        assert!(read(json!({"auto": 1.0, "collar": 0.5})).unwrap_err().contains("alone"));
        assert!(read(json!({"drillpip": 1.5})).unwrap_err().contains("drillpip"));
    }

    #[test]
    fn scaling_multiplies_all_lengths() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.scale_mesh(0.5);
        let ElementLengths { drillpipe, tool_joint, collar, stabilizer, bit } =
            *scenario.mesh.lengths_mut().unwrap();
        assert_eq!([drillpipe, tool_joint, collar, stabilizer, bit], [0.75, 0.15, 0.25, 0.25, 0.25]);
        scenario.mesh = Mesh::auto(0.5);
        scenario.scale_mesh(0.5);
        assert_eq!(scenario.mesh, Mesh::auto(0.25));
    }

    #[test]
    fn a_factor_does_not_depend_on_the_accuracy() {
        let mut scenario = preset("paper-200m").unwrap();
        let factors = AccuracyPreset::ALL.map(|accuracy| {
            scenario.accuracy = Accuracy::Preset(accuracy);
            scenario.mesh = Mesh::auto(0.75);
            assert_eq!(scenario.written_out_mesh(), WrittenOutMesh::Auto(0.75));
            scenario.mesh = Mesh::AUTO;
            let auto = scenario.accuracy.mesh_factor();
            assert_eq!(scenario.written_out_mesh(), WrittenOutMesh::Auto(auto));
            scenario.scale_mesh(0.5);
            assert_eq!(scenario.mesh, Mesh::auto(0.5 * auto));
            auto
        });
        assert!(factors.is_sorted_by(|looser, tighter| looser > tighter), "{factors:?}");
    }

    #[test]
    fn a_factor_on_auto_is_a_number_by_its_path() {
        let scenario = preset("paper-200m").unwrap();
        for mesh in [scenario.mesh, Mesh::AUTO] {
            let half = Scenario { mesh, ..scenario.clone() }.with("mesh.auto", json!(0.5));
            let mut half = half.unwrap();
            assert_eq!(half.mesh, Mesh::auto(0.5));
            *half.number_mut("mesh.auto").unwrap() = 0.25;
            assert_eq!(half.mesh, Mesh::auto(0.25));
        }
    }
}
