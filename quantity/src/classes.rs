//! Classes of points: words of the column `class`, with their order and colours.

/// One class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Class {
    /// Its word in the column.
    pub name: &'static str,
    /// Its colour in pictures, on light and dark grounds: red, green and blue in sRGB.
    pub colour: [u8; 3],
}

const fn class(name: &'static str, rgb: u32) -> Class {
    let [_, red, green, blue] = rgb.to_be_bytes();
    Class { name, colour: [red, green, blue] }
}

/// All classes, the most severe first. Colours are Okabe and Ito's, with darker ones in addition.
pub static CLASSES: [Class; 10] = [
    class("failed", 0x88_22_55),
    class("buckled", 0x7b_5f_d0),
    class("stick_slip", 0xd5_5e_00),
    class("backward_whirl", 0xe6_9f_00),
    class("impacts", 0xf0_e4_42),
    class("over_limit", 0xcc_79_a7),
    class("growing", 0x56_b4_e9),
    class("forward_whirl", 0x00_72_b2),
    class("quiet", 0x00_9e_73),
    class("not_judged", 0x75_75_75),
];

impl Class {
    /// The class of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        CLASSES.iter().find(|class| class.name == name)
    }

    /// Its colour as CSS has it, such as `#009e73`.
    pub fn css(&self) -> String {
        let [red, green, blue] = self.colour;
        format!("#{red:02x}{green:02x}{blue:02x}")
    }

    /// Its name in words.
    pub fn words(&self) -> String {
        self.name.replace('_', " ")
    }
}
