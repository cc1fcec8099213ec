//! What a specification says beside its numbers: names, words and lists of them, by the keys that lead to them.

use toml::de::{DeTable, DeValue};

/// A text, a truth or a list of such in a file.
pub struct Word {
    pub name: String,
    /// As TOML has it, on one line.
    pub value: String,
}

/// All words of a file, by their keys in the order of the alphabet; of one that is no TOML none.
pub fn words(text: &str) -> Vec<Word> {
    let mut words = Vec::new();
    if let Ok(table) = DeTable::parse(text) {
        in_table(table.get_ref(), "", &mut words);
    }
    words.sort_by(|a, b| a.name.cmp(&b.name));
    words
}

fn in_table(table: &DeTable, path: &str, words: &mut Vec<Word>) {
    for (key, value) in table {
        let path = if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
        in_value(value.get_ref(), path, words);
    }
}

fn in_value(value: &DeValue, name: String, words: &mut Vec<Word>) {
    match value {
        DeValue::Table(table) => in_table(table, &name, words),
        // Tables in a list are called by their numbers, as numbers in them are.
        DeValue::Array(elements) if elements.iter().any(|element| element.get_ref().is_table()) => {
            for (k, element) in elements.iter().enumerate() {
                in_value(element.get_ref(), format!("{name}.{}", k + 1), words);
            }
        }
        _ => words.extend(shown(value).map(|value| Word { name, value })),
    }
}

/// A value without numbers; what has some is told by its numbers.
fn shown(value: &DeValue) -> Option<String> {
    match value {
        DeValue::String(text) => Some(format!("{text:?}")),
        DeValue::Boolean(truth) => Some(truth.to_string()),
        DeValue::Array(elements) => {
            let elements: Option<Vec<String>> = elements.iter().map(|element| shown(element.get_ref())).collect();
            Some(format!("[{}]", elements?.join(", ")))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn what_is_no_number_is_a_word_and_what_is_one_is_none() {
        let text = "name = \"trot\" # of four\nvirtual_legs = [[\"a\",\n \"b\"], [\"c\"]]\nmass = 1\nmount = [0.1, 0, 0]\n\
                    [[phases]]\nstance = []\nduration = [0.1, 1]\n[[phases]]\nstance = ['leg1']\n";
        let words: Vec<String> =
            words(text).into_iter().map(|word| format!("{} = {}", word.name, word.value)).collect();
        let expected = [
            "name = \"trot\"",
            "phases.1.stance = []",
            "phases.2.stance = [\"leg1\"]",
            "virtual_legs = [[\"a\", \"b\"], [\"c\"]]",
        ];
        assert_eq!(words, expected);
    }
}
