//! The processor that a software driver draws with. Shaders are compiled for it. Approximate square roots and quotients
//! differ between processors: some pixels differ by 1 of 255.

/// The processor in a few words, such as `GenuineIntel 6 167 avx512f`; empty if unknown.
pub(super) fn processor() -> String {
    std::fs::read_to_string("/proc/cpuinfo").map(|text| described(&text)).unwrap_or_default()
}

/// The processor named in the first paragraph of `/proc/cpuinfo`.
fn described(text: &str) -> String {
    /// Maker and type on x86, and on Arm.
    const KEYS: [&str; 6] = ["vendor_id", "cpu family", "model", "CPU implementer", "CPU architecture", "CPU part"];
    /// Only the widest extension is named: a virtual machine may hide some.
    const VECTORS: [&str; 4] = ["avx512f", "avx2", "avx", "sve"];
    let first = text.split("\n\n").next().unwrap_or_default();
    let value = |wanted: &str| {
        let mut pairs = first.lines().filter_map(|line| line.split_once(':'));
        pairs.find(|(key, _)| key.trim() == wanted).map(|(_, value)| value.trim())
    };
    let flags = value("flags").or(value("Features")).unwrap_or_default();
    let vectors = VECTORS.into_iter().find(|vectors| flags.split(' ').any(|flag| flag == *vectors));
    KEYS.into_iter().filter_map(value).chain(vectors).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processors_are_described_by_maker_type_and_vectors() {
        let intel = "processor\t: 0\nvendor_id\t: GenuineIntel\ncpu family\t: 6\nmodel\t\t: 167\nmodel name\t: Xeon\n\
                     flags\t\t: fpu avx avx2 avx512f\n\nprocessor\t: 1\nvendor_id\t: Other\n";
        assert_eq!(described(intel), "GenuineIntel 6 167 avx512f");
        assert_eq!(described(&intel.replace(" avx512f", "")), "GenuineIntel 6 167 avx2");
        let arm = "processor\t: 0\nFeatures\t: fp asimd sve\nCPU implementer\t: 0x41\nCPU architecture: 8\nCPU part\t: 0xd40\n";
        assert_eq!(described(arm), "0x41 8 0xd40 sve");
        assert_eq!(described(""), "");
    }
}
