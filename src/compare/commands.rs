//! Commands that a reader of a report can copy.

use super::Method;
use crate::double;
use crate::measure::format::per_cent;

/// Conclusion of a comparison.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conclusion {
    /// One sentence.
    pub text: String,
    /// Command that shows it, to copy into a shell.
    pub command: Option<String>,
}

impl From<String> for Conclusion {
    fn from(text: String) -> Conclusion {
        Conclusion { text, command: None }
    }
}

impl From<&str> for Conclusion {
    fn from(text: &str) -> Conclusion {
        text.to_owned().into()
    }
}

/// Parts of commands, quoted for a shell.
#[derive(Clone, Debug)]
pub struct Commands {
    /// Command of the whole comparison.
    pub whole: String,
    /// File of the scene.
    pub scene: String,
    /// Options that change the scene: `-D /camera/fov=40`; empty if there are none.
    pub options: String,
    /// Size of the pictures: `--size 256x256`.
    pub size: String,
    /// The report's picture of the reference.
    pub reference: String,
}

impl Commands {
    /// Command that renders with a method up to an error; for pictures from files, or in double precision, the command of the whole comparison.
    pub fn render(&self, method: &Method, target: f64) -> String {
        if !method.files.is_empty() || method.integrator == double::NAME {
            return self.whole.clone();
        }
        let Method { integrator, sampler, .. } = method;
        format!("pt {} {} --integrator {integrator} --sampler {sampler} --target {}%", self.scene_of(method), self.size, per_cent(target))
    }

    /// Command that tests whether a method converges to the reference; for pictures from files it measures the first.
    pub fn verify(&self, method: &Method) -> String {
        if let Some(file) = method.files.first() {
            return format!("pt image diff {file} {}", self.reference);
        }
        if method.integrator == double::NAME {
            return format!("pt precision {} {}", self.scene_of(method), self.size);
        }
        format!("pt verify {} {} {} {}", self.scene_of(method), method.integrator, self.reference, self.size)
    }

    /// Lists the effects that the scene of a method calls for.
    pub fn check(&self, method: &Method) -> String {
        format!("pt check {}", self.scene_of(method))
    }

    /// The scene of a method with its options.
    fn scene_of(&self, method: &Method) -> String {
        let file = method.scene_file.as_ref().unwrap_or(&self.scene);
        if self.options.is_empty() { file.clone() } else { format!("{file} {}", self.options) }
    }
}
