// As much of a document as sections need to make their elements, without a browser.

class Element {
  constructor(tag) {
    Object.assign(this, { tag, attributes: {}, children: [], styles: {} });
    this.style = { setProperty: (name, value) => (this.styles[name] = value) };
    this.classList = { add: (name) => (this.attributes.class = `${this.attributes.class ?? ''} ${name}`.trim()) };
  }
  setAttribute(name, value) {
    this.attributes[name] = value;
  }
  append(child) {
    this.children.push(child);
  }
  addEventListener() {}
  get textContent() {
    return this.children.map((child) => child.textContent ?? child).join('');
  }
  /** All elements below of this tag and, if stated, class. */
  all(tag, name) {
    const below = this.children.flatMap((child) => (child instanceof Element ? [child, ...child.all('*')] : []));
    return below.filter((one) => (tag === '*' || one.tag === tag) && (!name || one.attributes.class?.split(' ').includes(name)));
  }
  querySelectorAll(selector) {
    return this.all(selector.split(' ').at(-1));
  }
}

globalThis.Node = Element;
globalThis.document = { createElement: (tag) => new Element(tag), createElementNS: (unused, tag) => new Element(tag) };
