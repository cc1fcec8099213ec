//! What keeps a file from being imported: all of it, each with its place and what to do about it.

use std::fmt;

/// What kind of fault it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The file is not XML, or nested beyond reason.
    Syntax,
    /// The file is neither URDF nor MJCF as they are written.
    Format,
    /// A number that is none.
    Number,
    /// Something that must be there and is not.
    Missing,
    /// The links do not form one tree.
    NotATree,
    /// A chain of links that closes on itself.
    Loop,
    /// An option that names nothing, or contradicts the file.
    Option,
    /// A joint that no leg can have.
    Joint,
    /// A joint about an axis that is none of the robot's.
    ObliqueAxis,
    /// A link with a mass or an inertia that no body has.
    Inertia,
    /// A joint without what makes an actuator, or with stops that are no angles.
    Limit,
    /// Which way is forward or up.
    Axes,
    /// A leg without a foot.
    NoFoot,
    /// The number of legs, or legs of which no gait can be made.
    Legs,
    /// What the specification's own checks say of the text.
    Specification,
}

/// An element of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// As it begins in the file: `<joint name="knee">`.
    pub element: String,
    /// From 1.
    pub line: usize,
}

/// Why a file cannot be imported, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    pub kind: Kind,
    pub what: String,
    pub place: Option<Place>,
    pub remedy: String,
}

/// Everything that keeps a file from being imported, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportError(pub Vec<Fault>);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, {}", self.line, self.element)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", ImportError(vec![self.clone()]))
    }
}

/// The same fault of several elements is said once.
impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut groups: Vec<(&Fault, Vec<&Place>)> = Vec::new();
        for fault in &self.0 {
            let alike =
                |(first, _): &&mut (&Fault, Vec<&Place>)| (&first.what, &first.remedy) == (&fault.what, &fault.remedy);
            match groups.iter_mut().find(alike) {
                Some((_, places)) => places.extend(&fault.place),
                None => groups.push((fault, fault.place.iter().collect())),
            }
        }
        let said = groups.iter().map(|(fault, places)| {
            let at: Vec<String> = places.iter().map(|place| place.to_string()).collect();
            let at = match &at[..] {
                [] => String::new(),
                [only] => format!("{only}: "),
                several => format!("{}:\n  ", several.join("\n")),
            };
            let remedy = if fault.remedy.is_empty() { String::new() } else { format!("\n  → {}", fault.remedy) };
            format!("{at}{}{remedy}", fault.what)
        });
        let said: Vec<String> = said.collect();
        if said.len() > 1 {
            writeln!(f, "{} things are in the way", said.len())?;
        }
        write!(f, "{}", said.join("\n"))
    }
}

impl std::error::Error for ImportError {}

/// Collects faults, each once.
#[derive(Debug, Default)]
pub struct Faults(Vec<Fault>);

impl Faults {
    pub fn add(&mut self, kind: Kind, place: Option<&Place>, what: impl Into<String>, remedy: impl Into<String>) {
        let fault = Fault { kind, what: what.into(), place: place.cloned(), remedy: remedy.into() };
        if !self.0.contains(&fault) {
            self.0.push(fault);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All faults, in the order of the file; none are left.
    pub fn take(&mut self) -> Vec<Fault> {
        let mut all = std::mem::take(&mut self.0);
        all.sort_by_key(|fault| fault.place.as_ref().map_or(usize::MAX, |place| place.line));
        all
    }

    /// An error if there was any fault.
    pub fn settle(&mut self) -> Result<(), ImportError> {
        if self.is_empty() { Ok(()) } else { Err(ImportError(self.take())) }
    }
}
