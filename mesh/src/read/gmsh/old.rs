//! The sections of version 2.2.

use super::Reader;
use crate::read::ReadError;
use crate::read::source::{Coding, Scalar};

impl Reader<'_> {
    pub(super) fn old_nodes(&mut self) -> Result<(), ReadError> {
        let count = self.source.count(Scalar::I32, "the number of nodes")?;
        self.builder.expect(count, 0)?;
        self.source.line();
        self.source.coding = self.coding;
        for _ in 0..count {
            let tag = self.int("the number of a node")?;
            let point = self.source.point(Scalar::F64)?;
            self.tags.node(tag, point, self.source.at - 1, &self.source, &mut self.builder)?;
        }
        self.source.coding = Coding::Text;
        Ok(())
    }

    pub(super) fn old_elements(&mut self) -> Result<(), ReadError> {
        let count = self.source.count(Scalar::I32, "the number of elements")?;
        self.source.line();
        self.source.coding = self.coding;
        let mut done = 0;
        while done < count {
            // In binary files, elements of one type with one number of tags stand together.
            let is_text = self.coding == Coding::Text;
            if is_text {
                self.int("the number of an element")?;
            }
            let start = self.source.at;
            let number = self.int("the type of an element")?;
            let kind = self.kind(number, start)?;
            let together = if is_text { 1 } else { self.source.count(Scalar::I32, "a number of elements")?.max(1) };
            let tags = self.source.count(Scalar::I32, "the number of tags")?;
            for _ in 0..together {
                if !is_text {
                    self.int("the number of an element")?;
                }
                // The first tag is the physical group.
                let mut physical = 0;
                for at in 0..tags {
                    let tag = self.int("a tag")?;
                    physical = if at == 0 { tag.saturating_abs() } else { physical };
                }
                let groups = if physical == 0 { &[][..] } else { &[physical] };
                self.element(kind, Scalar::I32, kind.dimension, groups)?;
            }
            done += together;
        }
        self.source.coding = Coding::Text;
        Ok(())
    }
}
