"""Everything read off states: fields, tension, energies, trust; and the verdict on them."""
