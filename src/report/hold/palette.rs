//! How the pictures of a hold are painted: with colours in files of their own, with CSS classes in a page.

use crate::{
    model::tool_part::ToolMaterial,
    report::bodies::{ARM_COLOURS, ArmPart},
};

/// Colour of the force in files.
const FORCE: &str = "#c8102e";

/// Where a picture is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// In a file on a white background, with colours.
    File,
    /// In a page whose style sheet has the colours, for light and dark mode.
    Page,
}

impl Palette {
    fn choose(self, file: &'static str, page: &'static str) -> &'static str {
        match self {
            Self::File => file,
            Self::Page => page,
        }
    }

    /// The SVG attributes of the board.
    #[must_use]
    pub fn board(self) -> &'static str {
        self.choose("fill=\"#e3c58f\" fill-opacity=\"0.85\" stroke=\"#8a6a2f\"", "class=\"board\"")
    }

    /// Those of a link with its own colour; a file has it, lightened so that outlines are visible, a page that of the arm.
    #[must_use]
    pub fn link(self, part: Option<ArmPart>, rgba: [f64; 4]) -> String {
        if self == Self::File {
            let [r, g, b] = [0, 1, 2].map(|channel| (255.0 * (0.45 + 0.55 * rgba[channel].clamp(0.0, 1.0))) as u8);
            return format!("fill=\"#{r:02x}{g:02x}{b:02x}\" stroke=\"#444444\"");
        }
        let Some(ArmPart { arm, is_hand }) = part else { return "class=\"still\"".to_owned() };
        format!("class=\"{}{}\"", if is_hand { "hand" } else { "arm" }, arm % ARM_COLOURS)
    }

    /// Those of outline and inside of the person.
    #[must_use]
    pub fn person(self) -> [String; 2] {
        [("stroke=\"#2f5f8a\"", "class=\"person-edge\""), ("stroke=\"#7fb2dc\"", "class=\"person\"")]
            .map(|(file, page)| self.choose(file, page).to_owned())
    }

    /// Those of outline and inside of an eye.
    #[must_use]
    pub fn eye(self) -> [String; 2] {
        [("stroke=\"#ffffff\"", "class=\"eye-edge\""), ("stroke=\"#111111\"", "class=\"eye\"")]
            .map(|(file, page)| self.choose(file, page).to_owned())
    }

    /// Those of a part of the tool.
    #[must_use]
    pub fn tool(self, material: ToolMaterial) -> &'static str {
        match material {
            ToolMaterial::Steel => self.choose("fill=\"#cfd4da\" stroke=\"#222222\"", "class=\"steel\""),
            ToolMaterial::Housing => self.choose("fill=\"#e07b39\" stroke=\"#222222\"", "class=\"housing\""),
            ToolMaterial::Grip => self.choose("fill=\"#4a4a4a\" stroke=\"#222222\"", "class=\"handle\""),
        }
    }

    /// Those of the line of sight.
    #[must_use]
    pub fn sight(self) -> &'static str {
        let file = "fill=\"none\" stroke=\"#17456e\" stroke-width=\"1.3\" stroke-dasharray=\"5 3\"";
        self.choose(file, "class=\"sight\"")
    }

    /// Those of the sector in front of the person.
    #[must_use]
    pub fn sector(self) -> &'static str {
        let file = "fill=\"#7fb2dc\" fill-opacity=\"0.18\" stroke=\"#2f5f8a\" stroke-width=\"0.8\"";
        self.choose(file, "class=\"sector\"")
    }

    /// Those of the line and of the head of a force.
    #[must_use]
    pub fn force(self) -> [String; 2] {
        match self {
            Self::File => [format!("stroke=\"{FORCE}\""), format!("fill=\"{FORCE}\"")],
            Self::Page => ["class=\"force\"", "class=\"force-head\""].map(str::to_owned),
        }
    }

    /// Those of the planned pose of what has moved since.
    #[must_use]
    pub fn ghost(self) -> &'static str {
        self.choose("fill=\"none\" stroke=\"#444444\" stroke-dasharray=\"4 2.5\"", "class=\"ghost\"")
    }

    /// Those of the name of a view.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.choose("fill=\"#666666\"", "class=\"name\"")
    }
}
