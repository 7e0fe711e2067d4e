//! What memory the machine, the group of the process and its own limits leave.

/// Budget where the system does not tell what is free, bytes.
const USUAL: u64 = 4 << 30;
/// Smallest budget, bytes.
const LEAST: u64 = 64 << 20;

/// Three quarters of the memory that the machine, the control group of the process and its limit of address space leave, bytes; 4 GiB
/// where the system is not Linux.
pub fn of_machine() -> u64 {
    match free() {
        Some(free) => (free / 4 * 3).max(LEAST),
        None => USUAL,
    }
}

/// Bytes that the limit of address space (`ulimit -v`) leaves to the process; `u64::MAX` without one.
pub fn address_space_left() -> u64 {
    let text = |name: &str| std::fs::read_to_string(name).ok();
    let most = text("/proc/self/limits").and_then(|t| address_space(&t));
    let taken = || text("/proc/self/status").and_then(|t| kib(&t, "VmSize:")).unwrap_or(0);
    most.map_or(u64::MAX, |most| most.saturating_sub(taken()).max(1))
}

/// Size of a page of memory, bytes; [`pages`] is right where pages are as large.
const PAGE: u64 = 4096;

/// Memory of the process, bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pages {
    /// Address space.
    pub space: u64,
    /// Memory that is its own: without that which it shares with others, such as its own code.
    pub held: u64,
}

/// Memory of the process; `None` where the system does not tell.
pub fn pages() -> Option<Pages> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let mut fields = text.split_whitespace().map_while(|field| field.parse::<u64>().ok());
    let [space, resident, shared] = [fields.next()?, fields.next()?, fields.next()?];
    Some(Pages { space: space * PAGE, held: resident.saturating_sub(shared) * PAGE })
}

#[cfg(not(target_os = "linux"))]
fn free() -> Option<u64> {
    None
}

#[cfg(target_os = "linux")]
fn free() -> Option<u64> {
    let text = |name: &str| std::fs::read_to_string(name).ok();
    let machine = text("/proc/meminfo").and_then(|t| kib(&t, "MemAvailable:"));
    let group = text("/proc/self/cgroup").and_then(|t| in_groups(&t, &text));
    let found = [machine, Some(address_space_left()), group];
    found.into_iter().flatten().min()
}

/// Bytes of a line such as `MemAvailable:   123 kB`.
fn kib(text: &str, key: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(key))?;
    rest.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// Soft limit of the address space, bytes; `None` = unlimited.
fn address_space(limits: &str) -> Option<u64> {
    let rest = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    rest.split_whitespace().next()?.parse().ok()
}

/// Bytes left by the control groups of the process and those above them, of both versions.
#[cfg(any(test, target_os = "linux"))]
fn in_groups(own: &str, text: &dyn Fn(&str) -> Option<String>) -> Option<u64> {
    let mut least: Option<u64> = None;
    for line in own.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(kinds), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (root, most, used) = if kinds.is_empty() {
            ("/sys/fs/cgroup", "memory.max", "memory.current")
        } else if kinds.split(',').any(|kind| kind == "memory") {
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes")
        } else {
            continue;
        };
        let mut path = path.trim_end_matches('/');
        loop {
            let number = |name: &str| text(&format!("{root}{path}/{name}"))?.trim().parse::<u64>().ok();
            if let (Some(most), Some(used)) = (number(most), number(used)) {
                // Pages of files that can be dropped count as used, but are free.
                let stat = text(&format!("{root}{path}/memory.stat")).unwrap_or_default();
                let of = |key: &str| {
                    stat.lines().find_map(|line| line.strip_prefix(key)).and_then(|n| n.trim().parse::<u64>().ok())
                };
                let kinds = ["inactive_file ", "active_file ", "slab_reclaimable "];
                let files: u64 =
                    kinds.iter().filter_map(|kind| of(&format!("total_{kind}")).or_else(|| of(kind))).sum();
                let left = most.saturating_sub(used.saturating_sub(files));
                least = Some(least.map_or(left, |l| l.min(left)));
            }
            let Some((above, _)) = path.rsplit_once('/') else { break };
            path = above;
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read() {
        assert_eq!(kib("MemFree: 1 kB\nMemAvailable:   2048 kB\n", "MemAvailable:"), Some(2 << 20));
        let limits =
            |word: &str| format!("Max processes  7 8 processes\nMax address space     {word}   unlimited  bytes\n");
        assert_eq!(address_space(&limits("4294967296")), Some(4 << 30));
        assert_eq!(address_space(&limits("unlimited")), None);
        assert!(of_machine() >= LEAST);
    }

    /// The group itself has no limit, the one above it has; pages of files are free.
    #[test]
    fn groups_above_count() {
        let files = |name: &str| {
            let text = match name {
                "/sys/fs/cgroup/a/b/memory.max" => "max",
                "/sys/fs/cgroup/a/b/memory.current" => "5",
                "/sys/fs/cgroup/a/memory.max" => "1000\n",
                "/sys/fs/cgroup/a/memory.current" => "700\n",
                "/sys/fs/cgroup/a/memory.stat" => "anon 1\ninactive_file 200\nactive_file 90\nslab_reclaimable 10\n",
                "/sys/fs/cgroup/memory/c/memory.limit_in_bytes" => "900",
                "/sys/fs/cgroup/memory/c/memory.usage_in_bytes" => "400",
                _ => return None,
            };
            Some(text.to_owned())
        };
        assert_eq!(in_groups("0::/a/b\n", &files), Some(600));
        assert_eq!(in_groups("3:cpu,memory:/c\n0::/a/b\n", &files), Some(500));
        assert_eq!(in_groups("0::/elsewhere\n", &files), None);
    }
}
