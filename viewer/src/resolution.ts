// How finely the view is drawn where there is no graphics card: as finely as it can be often enough, and fully once nothing
// moves.

/** A view that takes longer than this, milliseconds, is drawn with fewer pixels. */
const SLOW_MS = 40;
/** One that takes less, with more. */
const FAST_MS = 20;
/** What the mean begins with after a change. */
const BETWEEN_MS = 30;
/** Of a side's pixels, at a time; and at least. */
const STEP = 0.8;
const LEAST = 0.5;
/** How much the last time counts. */
const WEIGHT = 0.3;
/** After so long without a change nothing moves. */
const QUIET_MS = 200;

export class Resolution {
  private share = 1;
  private shown = 1;
  private mean = BETWEEN_MS;
  private changed = 0;

  /** Which share of the pixels of a side is to be drawn now, if it has to be drawn. */
  next(now: number, isChanged: boolean): number | null {
    if (isChanged) {
      this.changed = now;
      this.shown = this.share;
      return this.shown;
    }
    if (this.shown === 1 || now - this.changed < QUIET_MS) return null;
    this.shown = 1;
    return this.shown;
  }

  /** Takes how long it took, milliseconds. */
  tell(took: number) {
    // What was drawn once it stood does not count.
    if (this.shown !== this.share) return;
    this.mean += WEIGHT * (took - this.mean);
    if (this.mean > SLOW_MS) this.change(Math.max(LEAST, this.share * STEP));
    else if (this.mean < FAST_MS) this.change(Math.min(1, this.share / STEP));
  }

  private change(share: number) {
    this.share = share;
    this.mean = BETWEEN_MS;
  }
}
