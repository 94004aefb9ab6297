// The text of the scene, with its mistakes where they stand.

/** Height of a line of the text [pixels], as in the style sheet. */
const LINE = 18;

/** Mistakes that are marked and listed; where a text has more, the first ones are to be mended first. */
const MOST_PROBLEMS = 50;

class Editor {
  constructor(lab, open) {
    Object.assign(this, { lab, open, dialog: byId('editor'), text: byId('editor-text'), marks: byId('editor-marks'), list: byId('editor-problems') });
    this.text.addEventListener('input', () => {
      clearTimeout(this.waiting);
      this.number();
      this.waiting = setTimeout(() => this.check(), 350);
    });
    this.text.addEventListener('scroll', () => this.scroll());
    this.text.addEventListener('keydown', (event) => {
      if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) this.run();
    });
    byId('editor-run').onclick = () => this.run();
    byId('editor-save').onclick = () => save(`${fileName({ name: this.name })}.toml`, this.text.value, 'application/toml');
    byId('editor-file').onchange = (event) => this.load(event.target.files[0]);
  }

  /** Shows a text, or that of the drive. */
  show({ text, name } = this.lab.scene ?? { text: '', name: 'scene' }, problems = null) {
    this.name = name;
    this.text.value = text;
    if (!this.dialog.open) this.dialog.showModal();
    this.text.scrollTop = 0;
    this.text.setSelectionRange(0, 0);
    if (problems) this.tell(problems);
    else this.check();
  }

  async load(file) {
    if (!file) return;
    byId('editor-file').value = '';
    if (file.size > LARGEST_SCENE) {
      this.tell([{ message: `${file.name} is larger than 4 MB` }]);
      return;
    }
    this.show({ text: await file.text(), name: file.name });
  }

  async check() {
    const text = this.text.value;
    try {
      await this.lab.core.ask('read', { text, name: this.name });
      if (text === this.text.value) this.tell([]);
    } catch (error) {
      if (text === this.text.value) this.tell(error.problems ?? [{ message: error.message }]);
    }
  }

  async run() {
    try {
      await this.open({ text: this.text.value, name: this.name });
      this.dialog.close();
    } catch (error) {
      if (!error.ended) this.tell(error.problems ?? [{ message: error.message }]);
    }
  }

  /** Lists the mistakes, and marks their lines. */
  tell(problems) {
    this.problems = problems.slice(0, MOST_PROBLEMS);
    const more = problems.length - this.problems.length;
    byId('editor-run').disabled = false;
    byId('editor-state').textContent = problems.length ? `${problems.length} mistake${problems.length > 1 ? 's' : ''}` : 'No mistakes.';
    byId('editor-state').className = problems.length ? 'bad' : 'good';
    this.list.replaceChildren(...this.problems.map((problem) => this.item(problem)));
    if (more > 0) this.list.append(`and ${more} more`);
    this.marks.replaceChildren(...this.problems.filter((it) => it.line).map(({ line, columns, message }) => {
      const mark = document.createElement('div');
      mark.style.top = `${(line - 1) * LINE}px`;
      mark.title = message;
      if (columns) {
        const caret = document.createElement('span');
        caret.style.left = `${columns[0] - 1}ch`;
        caret.style.width = `${Math.max(1, columns[1] - columns[0] + 1)}ch`;
        mark.append(caret);
      }
      return mark;
    }));
    this.number();
    this.scroll();
  }

  /** Numbers of the lines. */
  number() {
    const lines = this.text.value.split('\n').length;
    if (lines === this.lines) return;
    this.lines = lines;
    byId('editor-lines').textContent = Array.from({ length: lines }, (_, i) => i + 1).join('\n');
  }

  item({ path, message, hint, line, columns, excerpt }) {
    const item = document.createElement('li');
    const button = document.createElement('button');
    button.type = 'button';
    const where = line ? `line ${line}: ` : '';
    button.textContent = `${where}${path ? `${path}: ` : ''}${message}`;
    button.disabled = !line;
    button.onclick = () => this.goTo(line, columns);
    item.append(button);
    if (excerpt) {
      const pre = document.createElement('pre');
      pre.textContent = excerpt;
      item.append(pre);
    }
    if (hint) {
      const p = document.createElement('p');
      p.textContent = hint;
      item.append(p);
    }
    return item;
  }

  /** Puts the caret at a mistake. */
  goTo(line, columns) {
    const lines = this.text.value.split('\n');
    const begin = lines.slice(0, line - 1).reduce((sum, it) => sum + it.length + 1, 0);
    const [from, to] = columns ? [columns[0] - 1, columns[1]] : [0, lines[line - 1]?.length ?? 0];
    this.text.focus();
    this.text.setSelectionRange(begin + from, begin + to);
    this.text.scrollTop = Math.max(0, (line - 4) * LINE);
  }

  scroll() {
    byId('editor-lines').style.transform = `translateY(${-this.text.scrollTop}px)`;
    this.marks.style.transform = `translate(${-this.text.scrollLeft}px, ${-this.text.scrollTop}px)`;
  }
}
