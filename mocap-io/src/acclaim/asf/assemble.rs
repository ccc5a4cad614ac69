//! Bones and hierarchy lines become a skeleton.

use super::{AngleUnit, Asf, Bone, Reader};
use crate::acclaim::names::Names;
use crate::{
    AxisFrame, Joint, LengthUnit, OffsetFrame, ParseError, ParseErrorKind, Skeleton, WarningKind,
};

impl Reader<'_> {
    /// Orders the bones depth first and makes them a skeleton.
    pub(super) fn finish(mut self) -> Result<Asf, ParseError> {
        let end = self.cursor.byte();
        let missing = |what| self.cursor.error_at(end, ParseErrorKind::Missing { what });
        let root = self.root.take().ok_or_else(|| missing(":root section"))?;
        if self.bones.is_empty() {
            return Err(missing(":bonedata section"));
        }
        if self.families.is_empty() {
            return Err(missing(":hierarchy section"));
        }
        self.note_units();
        let bones: Vec<Bone> = std::iter::once(root).chain(self.bones.drain(..)).collect();
        let children = self.children(&bones)?;
        let mut joints = Vec::with_capacity(bones.len());
        let mut stack = vec![(0, None)];
        while let Some((bone_idx, parent)) = stack.pop() {
            let joint_idx = joints.len();
            joints.push(self.joint(&bones[bone_idx], parent)?);
            stack.extend(
                children[bone_idx]
                    .iter()
                    .rev()
                    .map(|&c| (c, Some(joint_idx))),
            );
        }
        let skeleton = Skeleton::new(joints, OffsetFrame::Own).map_err(|_| {
            // Every number was checked, and parents were put before their children.
            let what = "consistent hierarchy";
            self.cursor.error_at(end, ParseErrorKind::Missing { what })
        })?;
        let angle_unit = self.angle_unit();
        Ok(Asf {
            name: self.name,
            skeleton,
            unit: self.unit.unwrap_or(LengthUnit::INCH),
            angle_unit,
            warnings: self.oddities.into_warnings(self.cursor.whole()),
        })
    }

    /// Says which units were assumed.
    fn note_units(&mut self) {
        if self.unit.is_none() {
            let (what, assumed) = ("length", "an inch");
            let kind = WarningKind::NoUnit { what, assumed };
            self.oddities.push(self.units_at, kind);
        }
        if self.angle_unit.is_none() {
            let (what, assumed) = ("angle", "a degree");
            let kind = WarningKind::NoUnit { what, assumed };
            self.oddities.push(self.units_at, kind);
        }
    }

    fn angle_unit(&self) -> AngleUnit {
        self.angle_unit.unwrap_or(AngleUnit::Degrees)
    }

    /// Children of each bone in file order. Every bone that the hierarchy names hangs on the root by
    /// exactly one parent.
    fn children(&mut self, bones: &[Bone]) -> Result<Vec<Vec<usize>>, ParseError> {
        let names = Names::new(bones.iter().map(|b| b.name.as_str()));
        for (bone_idx, bone) in bones.iter().enumerate() {
            if names.find_exact(&bone.name) != Some(bone_idx) {
                let (what, name) = ("bone", bone.name.clone());
                return Err(self
                    .cursor
                    .error_at(bone.at, ParseErrorKind::Twice { what, name }));
            }
        }
        let oddities = &mut self.oddities;
        let mut find = |name: &str, at: usize| {
            if let Some(bone_idx) = names.find_exact(name) {
                return Ok(bone_idx);
            }
            let found = name.to_owned();
            if let Some(bone_idx) = names.find_folded(name) {
                let name = bones[bone_idx].name.clone();
                oddities.push_once(at, WarningKind::NameCase { found, name });
                return Ok(bone_idx);
            }
            let kind = ParseErrorKind::UnknownBone {
                name: found,
                nearest: nearest(name, bones.iter().map(|b| b.name.as_str())),
            };
            Err(self.cursor.error_at(at, kind))
        };
        let mut children = vec![Vec::new(); bones.len()];
        let mut parent_of = vec![None; bones.len()];
        for family in &self.families {
            let parent = find(&family.parent.0, family.parent.1)?;
            for (child, at) in &family.children {
                let child = find(child, *at)?;
                if child == 0 || parent_of[child].replace(parent).is_some() {
                    let (what, name) = ("child", bones[child].name.clone());
                    return Err(self
                        .cursor
                        .error_at(*at, ParseErrorKind::Twice { what, name }));
                }
                children[parent].push(child);
            }
        }
        // With one parent each, a bone is connected unless its ancestors form a circle or end
        // at a bone without a parent.
        let mut connected = vec![false; bones.len()];
        let mut stack = vec![0];
        while let Some(bone_idx) = stack.pop() {
            connected[bone_idx] = true;
            stack.extend(&children[bone_idx]);
        }
        for bone_idx in (0..bones.len()).filter(|&i| !connected[i]) {
            let (at, name) = (bones[bone_idx].at, bones[bone_idx].name.clone());
            if parent_of[bone_idx].is_some() || !children[bone_idx].is_empty() {
                return Err(self
                    .cursor
                    .error_at(at, ParseErrorKind::Unconnected { name }));
            }
            self.oddities.push(at, WarningKind::LooseBone { name });
        }
        Ok(children)
    }

    fn joint(&mut self, bone: &Bone, parent: Option<usize>) -> Result<Joint, ParseError> {
        let offset = match parent {
            None => bone.direction,
            Some(_) => {
                if bone.length.is_none() {
                    let name = bone.name.clone();
                    self.oddities
                        .push_once(bone.at, WarningKind::NoLength { name });
                }
                let norm = bone.direction.iter().map(|v| v * v).sum::<f64>().sqrt();
                let length = bone.length.unwrap_or(0.0);
                let scale = length / norm;
                if length == 0.0 {
                    [0.0; 3]
                } else if norm.is_finite() && scale.is_finite() {
                    bone.direction.map(|v| v * scale)
                } else {
                    let (what, limit) = ("the direction's length", "positive and finite");
                    return Err(self.out_of_range(bone.at, what, limit, norm));
                }
            }
        };
        let degrees = bone.axis.degrees.map(|a| self.angle_unit().to_degrees(a));
        for (what, numbers) in [("the bone", offset), ("an axis angle", degrees)] {
            if let Some(&found) = numbers.iter().find(|v| !v.is_finite()) {
                return Err(self.out_of_range(bone.at, what, "finite", found));
            }
        }
        Ok(Joint {
            name: bone.name.clone(),
            parent,
            offset,
            channels: bone.dofs.clone(),
            axis: Some(AxisFrame {
                degrees,
                order: bone.axis.order,
            }),
            end_site: false,
        })
    }
}

/// The name with the smallest edit distance to `name`, unless more than half of it differs. The
/// distance takes time by the product of the lengths, so names longer than any bone's have none.
pub(crate) fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    /// Longest name that is compared, in bytes.
    const MAX_LEN: usize = 64;
    if name.len() > MAX_LEN {
        return None;
    }
    names
        .filter(|n| n.len() <= 2 * MAX_LEN)
        .map(|n| (strsim::levenshtein(name, n), n))
        .min()
        .filter(|&(distance, _)| 2 * distance <= name.len())
        .map(|(_, n)| n.to_owned())
}
