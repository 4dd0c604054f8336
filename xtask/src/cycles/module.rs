//! What one module of a crate declares and which paths it uses.

use crate::Result;
use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use syn::{
    Attribute, Ident, Item, ItemUse, Macro, Meta, UseTree, Visibility,
    ext::IdentExt,
    spanned::Spanned,
    visit::{self, Visit},
};

/// The names of a module, starting below the crate's root, or the segments of a path.
pub type Path = Vec<String>;

/// A path as it is written in the source.
pub struct Use {
    pub path: Path,
    pub line: usize,
    /// `pub use`: only makes the item visible elsewhere.
    pub exported: bool,
}

/// A module without its child modules.
#[derive(Default)]
pub struct Module {
    /// Names of functions, types, constants and macros.
    pub items: BTreeSet<String>,
    /// Names that `use` brings in, and their paths.
    pub imports: BTreeMap<String, Path>,
    /// Paths in front of `::*`.
    pub globs: Vec<Path>,
    pub uses: Vec<Use>,
    /// Child modules and their content, if that is not in a file of its own.
    pub children: Vec<(String, Option<Vec<Item>>)>,
    /// Whether the visitor is inside an item, whose imports are not the module's.
    inside: bool,
}

impl Module {
    /// Reads a file's text.
    pub fn parse(text: &str) -> Result<Vec<Item>> {
        let file = syn::parse_file(text).map_err(|e| format!("line {}: {e}", e.span().start().line))?;
        Ok(file.items)
    }

    pub fn new(items: &[Item]) -> Self {
        let mut module = Self::default();
        items.iter().for_each(|item| module.visit_item(item));
        module
    }

    fn declare(&mut self, name: &Ident) {
        if !self.inside {
            self.items.insert(name.unraw().to_string());
        }
    }

    fn import(&mut self, tree: &UseTree, mut path: Path, exported: bool) {
        let line = tree.span().start().line;
        let add = |module: &mut Self, path: Path, name: Option<String>| {
            if let Some(name) = name.filter(|_| !module.inside) {
                module.imports.insert(name, path.clone());
            }
            module.uses.push(Use { path, line, exported });
        };
        match tree {
            UseTree::Path(tree) => {
                path.push(tree.ident.unraw().to_string());
                self.import(&tree.tree, path, exported);
            }
            UseTree::Group(tree) => tree.items.iter().for_each(|item| self.import(item, path.clone(), exported)),
            UseTree::Name(tree) if tree.ident == "self" => {
                let name = path.last().cloned();
                add(self, path, name);
            }
            UseTree::Name(tree) => {
                path.push(tree.ident.unraw().to_string());
                let name = path.last().cloned();
                add(self, path, name);
            }
            UseTree::Rename(tree) => {
                if tree.ident != "self" {
                    path.push(tree.ident.unraw().to_string());
                }
                add(self, path, Some(tree.rename.unraw().to_string()));
            }
            UseTree::Glob(_) => {
                if !self.inside {
                    self.globs.push(path.clone());
                }
                add(self, path, None);
            }
        }
    }

    /// Paths of two or more segments in a macro's arguments, which are tokens only.
    fn scan(&mut self, tokens: TokenStream) {
        let (mut path, mut line, mut colons) = (Path::new(), 0, 0);
        for token in tokens {
            match token {
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.end(&mut path, line);
                        line = ident.span().start().line;
                    }
                    path.push(ident.unraw().to_string());
                    colons = 0;
                }
                other => {
                    self.end(&mut path, line);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.scan(group.stream());
                    }
                }
            }
        }
        self.end(&mut path, line);
    }

    fn end(&mut self, path: &mut Path, line: usize) {
        let path = std::mem::take(path);
        if path.len() > 1 {
            self.uses.push(Use { path, line, exported: false });
        }
    }
}

impl<'ast> Visit<'ast> for Module {
    fn visit_item(&mut self, item: &'ast Item) {
        let (name, attributes) = match item {
            Item::Const(item) => (Some(&item.ident), &item.attrs),
            Item::Enum(item) => (Some(&item.ident), &item.attrs),
            Item::Fn(item) => (Some(&item.sig.ident), &item.attrs),
            Item::Impl(item) => (None, &item.attrs),
            Item::Macro(item) => (item.ident.as_ref(), &item.attrs),
            Item::Mod(item) => (None, &item.attrs),
            Item::Static(item) => (Some(&item.ident), &item.attrs),
            Item::Struct(item) => (Some(&item.ident), &item.attrs),
            Item::Trait(item) => (Some(&item.ident), &item.attrs),
            Item::Type(item) => (Some(&item.ident), &item.attrs),
            Item::Union(item) => (Some(&item.ident), &item.attrs),
            Item::Use(item) => (None, &item.attrs),
            _ => return,
        };
        if is_test(attributes) {
            return;
        }
        if let Some(name) = name {
            self.declare(name);
        }
        match item {
            Item::Mod(item) => {
                let content = item.content.as_ref().map(|(_, items)| items.clone());
                self.children.push((item.ident.unraw().to_string(), content));
            }
            Item::Use(item) => self.visit_item_use(item),
            _ => {
                let outside = std::mem::replace(&mut self.inside, true);
                visit::visit_item(self, item);
                self.inside = outside;
            }
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        // With `::` in front it is another crate's.
        if item.leading_colon.is_none() {
            self.import(&item.tree, Path::new(), !matches!(item.vis, Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() && path.segments.len() > 1 {
            let line = path.span().start().line;
            let path = path.segments.iter().map(|segment| segment.ident.unraw().to_string()).collect();
            self.uses.push(Use { path, line, exported: false });
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'ast Macro) {
        self.visit_path(&item.path);
        self.scan(item.tokens.clone());
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

/// Whether an item is compiled for tests only.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => names(&list.tokens) == ["test"],
        _ => false,
    })
}

fn names(tokens: &TokenStream) -> Vec<String> {
    tokens.clone().into_iter().map(|token| token.to_string()).collect()
}
