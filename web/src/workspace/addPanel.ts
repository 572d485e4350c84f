import { addOf } from "./adding";
import { FOUND } from "./layout";
import { typeOf } from "./panels";

/** Puts a panel at the right of the bench, as soon as that is there: `go` leads to it. */
export function addPanel(kind: string, go: () => void): void {
  const type = typeOf(kind);
  const put = () => {
    const layout = FOUND.get();
    if (layout === undefined || layout.waiting || type === undefined) return;
    end();
    const there = Object.values(layout.document.panels).some((each) => each.type === kind);
    if (!(type.single && there)) layout.put(addOf(layout.document, type), `${type.title} is at the right`);
  };
  const end = FOUND.subscribe(put);
  if (FOUND.get() === undefined) go();
  else put();
}
