//! Sentences about arguments of calls, which every application names in its own way.

/// A sentence that names arguments of a call. As text it names them as the library does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Advice(Vec<Part>);

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Text(String),
    Argument(&'static str),
}

impl Advice {
    /// A sentence with an argument for each `{}`.
    ///
    /// * `template`: words of the program alone; those of users may hold `{}`, too, and come by [`Self::before`] and [`Self::then`].
    pub fn new(template: &str, arguments: &[&'static str]) -> Self {
        let mut arguments = arguments.iter();
        let mut parts = Vec::new();
        for (k, text) in template.split("{}").enumerate() {
            if k > 0 {
                parts.extend(arguments.next().map(|name| Part::Argument(name)));
            }
            parts.push(Part::Text(text.into()));
        }
        Self(parts)
    }

    /// That some options are for something, and what there is instead.
    pub fn of_options(options: &[&'static str], what: &str) -> Self {
        let (are, them) = if options.len() == 1 { ("is", "it") } else { ("are", "them") };
        Self::new(&format!("{} {are} ", vec!["{}"; options.len()].join(", ")), options)
            .then(format!("{what}; leave {them} out"))
    }

    /// The same after other words.
    pub fn before(mut self, text: impl Into<String>) -> Self {
        self.0.insert(0, Part::Text(text.into()));
        self
    }

    /// The same with other words after it.
    pub fn then(mut self, text: impl Into<String>) -> Self {
        self.0.push(Part::Text(text.into()));
        self
    }

    /// The sentence, in which `name` says how an argument is called.
    pub fn naming(&self, name: impl Fn(&'static str) -> String) -> String {
        let parts = self.0.iter().map(|part| match part {
            Part::Text(text) => text.clone(),
            Part::Argument(argument) => name(argument),
        });
        parts.collect()
    }
}

impl std::fmt::Display for Advice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.naming(|name| format!("`{name}`")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_named_by_whom_it_tells_and_words_of_users_stay() {
        let advice = Advice::new("give {} and {}", &["eye", "look"]).before("{} is hidden; ").then(", not {}");
        assert_eq!(advice.to_string(), "{} is hidden; give `eye` and `look`, not {}");
        assert_eq!(advice.naming(|name| format!("--{name}")), "{} is hidden; give --eye and --look, not {}");
    }
}
