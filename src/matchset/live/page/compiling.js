// Says that the first click waits for the compiler, only once on a machine.

export class CompilingPanel {
  constructor(root) {
    this.root = root;
  }

  update({ kernels, seconds, done }) {
    this.root.hidden = done || !kernels;
    this.root.textContent = `Compiling, only once on this machine: ${kernels} pieces in ${seconds} s. A click is answered after that.`;
  }
}
