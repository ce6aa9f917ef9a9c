//! Links and joints of a file: a tree.

use std::collections::HashMap;

use ferntast_model::rigid_body::{LinkInertia, Matrix3, Placement, Vector3};

use crate::{
    did_you_mean,
    document::{self, Element},
    error::ReadError,
    solid::{self, Placed},
};

/// How a joint of a URDF moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointType {
    /// It turns between two ends.
    Revolute,
    /// It turns without end.
    Continuous,
    /// It slides.
    Prismatic,
    /// Not at all.
    Fixed,
    /// In all six directions.
    Floating,
    /// In a plane.
    Planar,
}

/// A joint's `<limit>`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Least position \[rad\] or \[m\].
    pub lower: f64,
    /// Greatest position \[rad\] or \[m\].
    pub upper: f64,
    /// Greatest torque \[Nm\] or force \[N\], where the file tells it.
    pub effort: Option<f64>,
    /// Greatest speed \[rad/s\] or \[m/s\], where the file tells it.
    pub velocity: Option<f64>,
}

/// A `<joint>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Where it is in the file, from 1.
    pub line: usize,
    /// How it moves.
    pub joint_type: JointType,
    /// Number of the link before it, in [`Robot::links`].
    pub parent: usize,
    /// Number of the link that it carries.
    pub child: usize,
    /// The child's frame at position zero, in that of the parent.
    pub origin: Placement,
    /// Its direction in the child's frame; (1, 0, 0) where the file has none.
    pub axis: Vector3<f64>,
    /// Its ends.
    pub limit: Option<Limit>,
    /// The joint that it follows.
    pub mimics: Option<String>,
}

/// A `<link>`.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// Where it is in the file, from 1.
    pub line: usize,
    /// Its masses in its own frame; none where the file has none.
    pub inertia: Option<LinkInertia>,
    /// What it looks like, as far as the file tells it without meshes.
    pub shapes: Vec<Placed>,
}

/// Everything that a file says of links and joints: one or more trees.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// In the order of the file.
    pub links: Vec<Link>,
    /// In the order of the file.
    pub joints: Vec<Joint>,
    /// The joint that carries each link, by the link's number.
    pub(crate) carried_by: Vec<Option<usize>>,
}

impl Robot {
    /// Reads the bytes of a URDF file.
    ///
    /// # Errors
    ///
    /// [`ReadError`], with the line that is wrong.
    pub fn read(file: &[u8]) -> Result<Robot, ReadError> {
        let text = document::text(file)?;
        let document = document::parse(text)?;
        let line_ends = document::line_ends(text);
        let root = Element::root(&document, &line_ends);
        if root.name() != "robot" {
            return Err(ReadError::NoRobot {
                line: root.line(),
                found: root.name().to_owned(),
            });
        }
        if let Some(element) = root.children().find(Element::is_xacro) {
            return Err(ReadError::Xacro {
                line: element.line(),
                element: element.name().to_owned(),
            });
        }
        let of = |name: &'static str| root.children().filter(move |child| child.name() == name);
        let links: Vec<Link> = of("link").map(link).collect::<Result<_, _>>()?;
        let numbers = numbered("link", links.iter().map(|link| (&link.name, link.line)))?;
        let joints: Vec<Joint> = of("joint")
            .map(|element| joint(element, &numbers))
            .collect::<Result<_, _>>()?;
        numbered(
            "joint",
            joints.iter().map(|joint| (&joint.name, joint.line)),
        )?;
        let carried_by = tree(&links, &joints)?;
        Ok(Robot {
            links,
            joints,
            carried_by,
        })
    }
}

/// By name, the number of each.
fn numbered<'a>(
    what: &'static str,
    names: impl Iterator<Item = (&'a String, usize)>,
) -> Result<HashMap<&'a str, usize>, ReadError> {
    let mut numbers = HashMap::new();
    for (number, (name, line)) in names.enumerate() {
        if numbers.insert(name.as_str(), number).is_some() {
            let name = name.clone();
            return Err(ReadError::Twice { line, what, name });
        }
    }
    Ok(numbers)
}

/// By link, the joint that carries it; refuses loops.
fn tree(links: &[Link], joints: &[Joint]) -> Result<Vec<Option<usize>>, ReadError> {
    let mut carried_by: Vec<Option<usize>> = vec![None; links.len()];
    for (number, joint) in joints.iter().enumerate() {
        if let Some(first) = carried_by[joint.child].replace(number) {
            return Err(ReadError::Loop {
                line: joint.line,
                link: links[joint.child].name.clone(),
                first: joints[first].name.clone(),
                second: joint.name.clone(),
            });
        }
    }
    // What no way from a link without a joint leads to, goes round in a circle.
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    for joint in joints {
        below[joint.parent].push(joint.child);
    }
    let mut reached = vec![false; links.len()];
    let mut left: Vec<usize> = (0..links.len())
        .filter(|link| carried_by[*link].is_none())
        .collect();
    while let Some(link) = left.pop() {
        reached[link] = true;
        left.extend(&below[link]);
    }
    match joints.iter().find(|joint| !reached[joint.child]) {
        None => Ok(carried_by),
        Some(joint) => Err(ReadError::Circle {
            line: joint.line,
            joint: joint.name.clone(),
        }),
    }
}

fn link(element: Element<'_>) -> Result<Link, ReadError> {
    let name = element.required(element.attribute("name"), "name")?;
    let inertia = match element.child("inertial") {
        None => None,
        Some(inertial) => Some(inertia(name, inertial)?),
    };
    Ok(Link {
        name: name.to_owned(),
        line: element.line(),
        inertia,
        shapes: solid::shapes(&element),
    })
}

/// Masses of the link of this name, in its frame.
fn inertia(link: &str, inertial: Element<'_>) -> Result<LinkInertia, ReadError> {
    let mass = inertial.required(inertial.child("mass"), "<mass>")?;
    let kilograms = mass.required(mass.number("value")?, "value")?;
    if kilograms < 0.0 {
        return Err(ReadError::NegativeMass {
            line: mass.line(),
            link: link.to_owned(),
            mass: kilograms,
        });
    }
    let moments = inertial.required(inertial.child("inertia"), "<inertia>")?;
    let moment = |name: &'static str| moments.required(moments.number(name)?, name);
    let (xx, yy, zz) = (moment("ixx")?, moment("iyy")?, moment("izz")?);
    // Of the products of inertia those that are left out are zero.
    let product = |name: &'static str| Ok(moments.number(name)?.unwrap_or(0.0));
    let (xy, xz, yz) = (product("ixy")?, product("ixz")?, product("iyz")?);
    let about_center = LinkInertia {
        mass: kilograms,
        first_moment: Vector3::zeros(),
        rotational: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    };
    Ok(about_center.placed(&inertial.origin()?))
}

fn joint(element: Element<'_>, links: &HashMap<&str, usize>) -> Result<Joint, ReadError> {
    let name = element.required(element.attribute("name"), "name")?;
    let line = element.line();
    let link = |end: &str, missing| {
        let end = element.required(element.child(end), missing)?;
        let wanted = end.required(end.attribute("link"), "link")?;
        let found = links.get(wanted).copied();
        found.ok_or_else(|| {
            let mut names: Vec<&str> = links.keys().copied().collect();
            names.sort_unstable();
            ReadError::NoSuchLink {
                line: end.line(),
                joint: name.to_owned(),
                link: wanted.to_owned(),
                nearest: did_you_mean(wanted, names.into_iter()),
            }
        })
    };
    let axis = match element.child("axis") {
        None => [1.0, 0.0, 0.0],
        Some(axis) => axis.required(axis.numbers("xyz")?, "xyz")?,
    };
    let mimics = element.child("mimic").map(|mimic| {
        let of = mimic.attribute("joint").unwrap_or_default();
        of.to_owned()
    });
    Ok(Joint {
        name: name.to_owned(),
        line,
        joint_type: joint_type(element, name)?,
        parent: link("parent", "<parent>")?,
        child: link("child", "<child>")?,
        origin: element.origin()?,
        axis: axis.into(),
        limit: element.child("limit").map(limit).transpose()?,
        mimics,
    })
}

fn joint_type(element: Element<'_>, name: &str) -> Result<JointType, ReadError> {
    Ok(match element.required(element.attribute("type"), "type")? {
        "revolute" => JointType::Revolute,
        "continuous" => JointType::Continuous,
        "prismatic" => JointType::Prismatic,
        "fixed" => JointType::Fixed,
        "floating" => JointType::Floating,
        "planar" => JointType::Planar,
        found => {
            return Err(ReadError::JointType {
                line: element.line(),
                joint: name.to_owned(),
                found: found.to_owned(),
            });
        }
    })
}

fn limit(element: Element<'_>) -> Result<Limit, ReadError> {
    Ok(Limit {
        // Zero where they are left out, as URDF says.
        lower: element.number("lower")?.unwrap_or(0.0),
        upper: element.number("upper")?.unwrap_or(0.0),
        effort: element.number("effort")?,
        velocity: element.number("velocity")?,
    })
}
