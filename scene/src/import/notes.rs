//! What an importer ignored or assumed.

/// Sentences for the user, each once, in the order in which they arose.
#[derive(Debug, Default)]
pub struct Notes(Vec<String>);

impl Notes {
    /// Adds a note, unless it is there already.
    pub fn add(&mut self, note: String) {
        if !self.0.contains(&note) {
            self.0.push(note);
        }
    }

    pub fn into_list(self) -> Vec<String> {
        self.0
    }
}
