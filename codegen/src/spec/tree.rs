//! The links and joints must form chains on one platform: each link hangs on one joint at most, no link
//! hangs on itself, each link of a leg carries one joint at most, and one link, the platform, hangs on none.

use super::Code;
use super::chain::Parts;
use super::diagnostic::Sink;
use super::robot::RawJoint;

impl Parts {
    /// The joint that carries a link.
    fn joint_above(&self, link: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.child.as_ref().is_some_and(|c| c.value == link))
    }

    /// The joints that hang on a link.
    pub fn joints_below(&self, link: &str) -> Vec<usize> {
        let below = |j: &RawJoint| j.parent.as_ref().is_some_and(|p| p.value == link);
        (0..self.joints.len()).filter(|&j| below(&self.joints[j])).collect()
    }

    /// No link with two parents, no circles, no branches.
    pub fn check_tree(&self, sink: &mut Sink) -> bool {
        let parents = self.check_one_parent(sink);
        parents && self.check_no_cycle(sink) && self.check_no_branch(sink)
    }

    fn check_one_parent(&self, sink: &mut Sink) -> bool {
        let mut good = true;
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(child) = &joint.child else { continue };
            let Some(first) = self.joint_above(&child.value).filter(|&first| first < i) else {
                continue;
            };
            let first = &self.joints[first];
            let title = format!("link `{}` is the child of two joints", child.value);
            let label = format!("`{}` carries it too", joint.name.value);
            let help = format!(
                "a link hangs on one joint: give `{}` another child, or describe one more link \
                 (legs of the same build can share their joints and links)",
                joint.name.value
            );
            sink.report(Code::TwoParents, title, &child.span, label, help);
            if let Some(theirs) = &first.child {
                sink.beside(sink.label(&theirs.span, format!("`{}` carries it", first.name.value)));
            }
            good = false;
        }
        good
    }

    fn check_no_cycle(&self, sink: &mut Sink) -> bool {
        let mut seen = vec![false; self.joints.len()];
        let mut good = true;
        for start in 0..self.joints.len() {
            // Walk towards the platform; meeting a joint of this very walk closes a circle.
            let mut walk: Vec<usize> = Vec::new();
            let mut here = Some(start);
            while let Some(joint) = here.filter(|&j| !seen[j]) {
                seen[joint] = true;
                walk.push(joint);
                here = self.joints[joint].parent.as_ref().and_then(|p| self.joint_above(&p.value));
            }
            let Some(from) = here.and_then(|joint| walk.iter().position(|&w| w == joint)) else {
                continue;
            };
            let circle = &walk[from..];
            let names: Vec<_> = circle.iter().map(|&j| format!("`{}`", self.joints[j].name.value)).collect();
            let Some(parent) =
                circle.iter().filter_map(|&j| self.joints[j].parent.as_ref()).min_by_key(|p| p.span.start)
            else {
                continue;
            };
            let title = match names.len() {
                1 => format!("joint {} ties a link to itself", names.join("")),
                _ => format!("the links of {} hang on each other in a circle", names.join(", ")),
            };
            let help = "every chain starts at the platform: let one of these joints have it as its parent";
            sink.report(Code::Cycle, title, &parent.span, "its own chain leads back here", help);
            good = false;
        }
        good
    }

    fn check_no_branch(&self, sink: &mut Sink) -> bool {
        let mut good = true;
        for (link, _) in &self.links {
            let below = self.joints_below(&link.value);
            let [first, second, ..] = below[..] else {
                continue;
            };
            if self.joint_above(&link.value).is_none() {
                continue; // the platform
            }
            let (first, second) = (&self.joints[first], &self.joints[second]);
            let title = format!("the chain branches at link `{}`", link.value);
            let label = format!("joint `{}` hangs on it too", second.name.value);
            let help = "a leg is a chain without branches: let one of the two joints hang on another link";
            let span = second.parent.as_ref().map_or(&second.name.span, |p| &p.span);
            sink.report(Code::Branch, title, span, label, help);
            let span = first.parent.as_ref().map_or(&first.name.span, |p| &p.span);
            sink.beside(sink.label(span, format!("joint `{}` hangs on it", first.name.value)));
            good = false;
        }
        good
    }

    /// The one link that carries joints and hangs on none.
    pub fn platform(&self, sink: &mut Sink) -> Option<usize> {
        let mut platforms = Vec::new();
        for (i, (link, _)) in self.links.iter().enumerate() {
            match (self.joint_above(&link.value), self.joints_below(&link.value).is_empty()) {
                (Some(_), _) => {}
                (None, false) => platforms.push(i),
                (None, true) if self.joints.is_empty() => {}
                (None, true) => {
                    let title = format!("link `{}` is not used", link.value);
                    let help = format!("let a joint have child = \"{}\", or remove it", link.value);
                    sink.report(Code::Unused, title, &link.span, "no joint mentions it", help);
                }
            }
        }
        match platforms[..] {
            [platform] => Some(platform),
            [] => {
                let title = "there is no platform: a link that carries joints and hangs on none";
                let help = "add a joint whose parent is the platform: [joints.<name>]";
                sink.report(Code::NotOnePlatform, title, &self.joints_at, "no joint here has it as parent", help);
                None
            }
            [first, second, ..] => {
                let [first, second] = [first, second].map(|i| &self.links[i].0);
                let title = format!("both `{}` and `{}` could be the platform", first.value, second.value);
                let help = format!(
                    "the platform is the only link that is no joint's child: let a joint have child = \"{}\"",
                    second.value
                );
                sink.report(Code::NotOnePlatform, title, &second.span, "no joint carries this link", help);
                sink.beside(sink.label(&first.span, "nor this one"));
                None
            }
        }
    }
}
