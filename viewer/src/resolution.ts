// The resolution of the view without a graphics card: full while nothing moves, otherwise as fine as the frame rate
// allows.

/** If drawing takes longer than this, in milliseconds, the resolution is reduced. */
const SLOW_MS = 40;
/** If drawing takes less than this, the resolution is increased. */
const FAST_MS = 20;
/** Initial value of the mean after a change. */
const BETWEEN_MS = 30;
/** Factor of one step, and the least fraction, of the pixels of a side. */
const STEP = 0.8;
const LEAST = 0.5;
/** Weight of the last time in the mean. */
const WEIGHT = 0.3;
/** The view counts as still after this time without a change. */
const QUIET_MS = 200;

export class Resolution {
  private share = 1;
  private shown = 1;
  private mean = BETWEEN_MS;
  private changed = 0;

  /** Returns the fraction of the pixels of a side to draw now, if the view must be drawn. */
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

  /** Adds the time that drawing took, in milliseconds. */
  tell(took: number) {
    // Drawing in full resolution, while nothing moves, does not count.
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
