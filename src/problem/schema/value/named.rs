//! Values of the problem file that are chosen by name.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::camera::Lens;
use crate::information::{Criterion, NoiseName};
use crate::problem::{Least, Method, RobustGoal};
use crate::robot::JointKind;
use crate::robot::dh::Convention;
use crate::sweep::AxisRule;

/// A value written as one of a fixed list of names. The names belong to the models; this gives them to serde.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Named<T>(pub(crate) T);

/// A type with a fixed list of named values.
pub(crate) trait Choice: Copy + 'static {
    fn all() -> &'static [Self];
    fn name(self) -> &'static str;
}

impl<'de, T: Choice> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ByName<T>(PhantomData<T>);
        impl<T: Choice> Visitor<'_> for ByName<T> {
            type Value = Named<T>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "one of {}", Names(T::all()))
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Self::Value, E> {
                let found = T::all().iter().find(|choice| choice.name() == name);
                // The wording of serde's own `unknown_variant`, which takes only a static list.
                found
                    .map(|&choice| Named(choice))
                    .ok_or_else(|| E::custom(format_args!("unknown variant `{name}`, expected {}", Names(T::all()))))
            }
        }
        deserializer.deserialize_str(ByName(PhantomData))
    }
}

impl<T: Choice> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl<T: Choice> JsonSchema for Named<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Choice".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<&str> = T::all().iter().map(|choice| choice.name()).collect();
        json_schema!({ "type": "string", "enum": names })
    }
}

struct Names<T: 'static>(&'static [T]);

impl<T: Choice> fmt::Display for Names<T> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, choice) in self.0.iter().enumerate() {
            write!(f, "{}`{}`", if i == 0 { "" } else { ", " }, choice.name())?;
        }
        Ok(())
    }
}

/// Camera mounts that need no numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MountName {
    /// The camera frame is the flange frame.
    OpticalAxisZ,
    /// The optical axis is the flange's x: `z_C = x_F, y_C = −y_F, x_C = z_F`.
    OpticalAxisX,
    /// The flange frame is ROS's `camera_optical_frame`: the camera's own.
    RosOptical,
    /// The flange frame is ROS's body frame, as of `camera_link`, x forward, y left, z up: `z_C = x_F, x_C = −y_F, y_C = −z_F`.
    RosBody,
    /// The flange frame is that of `OpenGL`, Blender or USD, y up, looking along −z: `x_C = x_F, y_C = −y_F, z_C = −z_F`.
    OpenGl,
}

impl Choice for MountName {
    fn all() -> &'static [Self] {
        &[Self::OpticalAxisZ, Self::OpticalAxisX, Self::RosOptical, Self::RosBody, Self::OpenGl]
    }

    fn name(self) -> &'static str {
        match self {
            Self::OpticalAxisZ => "optical-axis-z",
            Self::OpticalAxisX => "optical-axis-x",
            Self::RosOptical => "ros-optical",
            Self::RosBody => "ros-body",
            Self::OpenGl => "opengl",
        }
    }
}

impl Choice for RobustGoal {
    fn all() -> &'static [Self] {
        &Self::ALL
    }

    fn name(self) -> &'static str {
        self.name()
    }
}

impl Choice for Least {
    fn all() -> &'static [Self] {
        &Self::ALL
    }

    fn name(self) -> &'static str {
        self.name()
    }
}

impl Choice for NoiseName {
    fn all() -> &'static [Self] {
        &Self::ALL
    }

    fn name(self) -> &'static str {
        self.name()
    }
}

impl Choice for Convention {
    fn all() -> &'static [Self] {
        &[Self::Standard, Self::Modified]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Modified => "modified",
        }
    }
}

impl Choice for JointKind {
    fn all() -> &'static [Self] {
        &[Self::Revolute, Self::Prismatic]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
        }
    }
}

impl Choice for AxisRule {
    fn all() -> &'static [Self] {
        &[Self::Any, Self::Zone]
    }

    fn name(self) -> &'static str {
        match self {
            Self::Any => "any",
            Self::Zone => "zone",
        }
    }
}

impl Choice for Lens {
    fn all() -> &'static [Self] {
        &Self::ALL
    }

    fn name(self) -> &'static str {
        self.name()
    }
}

impl Choice for Criterion {
    fn all() -> &'static [Self] {
        &Self::ALL
    }

    fn name(self) -> &'static str {
        self.name()
    }
}

impl Choice for Method {
    fn all() -> &'static [Self] {
        &Self::ALL
    }

    fn name(self) -> &'static str {
        self.name()
    }
}
