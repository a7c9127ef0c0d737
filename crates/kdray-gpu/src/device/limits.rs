//! How much a device may be asked for.

use crate::error::GpuError;

/// What kernels and buffers must keep to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Storage buffers that a kernel may bind.
    pub storage_buffers: u32,
    /// Bytes of a buffer that a kernel may bind.
    pub binding_bytes: u64,
    /// Bytes of a buffer.
    pub buffer_bytes: u64,
    /// Bytes of memory that the invocations of a workgroup may share.
    pub workgroup_bytes: u32,
    /// Invocations of a workgroup.
    pub invocations: u32,
    /// Workgroups of a dispatch along one dimension.
    pub workgroups: u32,
}

impl Limits {
    /// What every implementation of WebGPU has.
    pub const PORTABLE: Self = Self {
        storage_buffers: 8,
        binding_bytes: 128 << 20,
        buffer_bytes: 256 << 20,
        workgroup_bytes: 16 << 10,
        invocations: 256,
        workgroups: 65_535,
    };

    /// The same, with buffers as large as `self` has them.
    #[must_use]
    pub fn portable_with_large_buffers(&self) -> Self {
        let Self { binding_bytes, buffer_bytes, .. } = *self;
        Self { binding_bytes, buffer_bytes, ..Self::PORTABLE }
    }

    pub(super) fn of(limits: &wgpu::Limits) -> Self {
        Self {
            storage_buffers: limits.max_storage_buffers_per_shader_stage,
            binding_bytes: limits.max_storage_buffer_binding_size,
            buffer_bytes: limits.max_buffer_size,
            workgroup_bytes: limits.max_compute_workgroup_storage_size,
            invocations: limits.max_compute_invocations_per_workgroup,
            workgroups: limits.max_compute_workgroups_per_dimension,
        }
    }

    /// The limits of an adapter, with these in place of its own.
    pub(super) fn within(&self, offered: &wgpu::Limits) -> wgpu::Limits {
        wgpu::Limits {
            max_storage_buffers_per_shader_stage: self.storage_buffers,
            max_storage_buffer_binding_size: self.binding_bytes,
            max_buffer_size: self.buffer_bytes,
            max_compute_workgroup_storage_size: self.workgroup_bytes,
            max_compute_invocations_per_workgroup: self.invocations,
            max_compute_workgroup_size_x: self.invocations,
            max_compute_workgroups_per_dimension: self.workgroups,
            ..offered.clone()
        }
    }

    /// Fails if `self` asks for more than `offered` has.
    pub(super) fn check(&self, offered: &Self, adapter: &str) -> Result<(), GpuError> {
        let offered = offered.named();
        let lacking = self.named().into_iter().zip(offered).find(|(asked, has)| asked.1 > has.1);
        lacking.map_or(Ok(()), |((limit, asked), (_, offered))| {
            Err(GpuError::Limit { adapter: adapter.to_owned(), limit, asked, offered })
        })
    }

    /// Every limit with its name.
    #[must_use]
    pub fn named(&self) -> [(&'static str, u64); 6] {
        [
            ("storage_buffers", self.storage_buffers.into()),
            ("binding_bytes", self.binding_bytes),
            ("buffer_bytes", self.buffer_bytes),
            ("workgroup_bytes", self.workgroup_bytes.into()),
            ("invocations", self.invocations.into()),
            ("workgroups", self.workgroups.into()),
        ]
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::PORTABLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_that_is_too_high_is_named() {
        let asked = Limits { invocations: 512, ..Limits::PORTABLE };
        let error = asked.check(&Limits::PORTABLE, "toy").unwrap_err();
        assert_eq!(error.to_string(), "toy offers invocations of 256, and 512 are needed");
        assert_eq!(Limits::PORTABLE.check(&asked, "toy"), Ok(()));
    }

    #[test]
    fn portable_limits_are_those_of_webgpu() {
        assert_eq!(Limits::of(&wgpu::Limits::default()), Limits::PORTABLE);
    }
}
