// Counts what is waited for.

export class Waiting {
  private count = 0;

  get busy(): boolean {
    return this.count > 0;
  }

  /** Waits for something. */
  async for<T>(work: () => Promise<T>): Promise<T> {
    this.count += 1;
    try {
      return await work();
    } finally {
      this.count -= 1;
    }
  }
}
