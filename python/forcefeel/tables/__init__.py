"""Tables of numbers that a user hands over: columns with their units in a CSV, Parquet or MATLAB file, all read the same way.

To read in this order: ``table``, what is read; ``table_file``, by which of ``csv_table``, ``parquet_table``, ``mcap_table`` and
``matlab_table`` (``matlab_file`` knows that format); ``header``, which columns are meant and in what unit; ``column_names``,
what options say of them; ``between``, a part of a record; ``faults``, what is wrong with the numbers.
"""
